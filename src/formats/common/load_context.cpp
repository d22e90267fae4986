// SPDX-License-Identifier: Apache-2.0
#include "formats/common/load_context.h"

#include <algorithm>

#include "fathom/error.h"

namespace fathom {

namespace fs = std::filesystem;

namespace {

std::string lower(std::string text)
{
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return text;
}

bool is_there(const fs::path& file)
{
    std::error_code error;
    return fs::exists(file, error);
}

fs::path folder_of(const fs::path& file)
{
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

LoadContext::LoadContext(const fs::path& file, bool confine, Warnings& w) : warnings(w)
{
    if (!confine) return;
    std::error_code error;
    folder_ = fs::canonical(folder_of(file), error);
    if (error) throw Error(file.string(), "", error.message());
}

void LoadContext::check_inside(const fs::path& file) const
{
    if (folder_.empty()) return;
    std::error_code error;
    const fs::path real = fs::weakly_canonical(fs::absolute(file), error);
    if (error || std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end()).first != folder_.end())
        throw Error(file.string(), "", "is outside the scene's folder, and the scene is confined to it (--confine)");
}

const LoadContext::Names& LoadContext::names_in(const fs::path& folder)
{
    const auto [found, is_new] = names_.try_emplace(folder);
    if (!is_new) return found->second;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        const auto [same, is_first] = found->second.emplace(lower(name), name);
        // Directory order is arbitrary, so the least name makes the result deterministic.
        if (!is_first) same->second = std::min(same->second, name);
    }
    return found->second;
}

fs::path LoadContext::locate(const fs::path& file)
{
    // Paths outside the folder are rejected before the existence of files is tested, which a scene must not be able to
    // probe.
    check_inside(file);
    if (is_there(file)) return file;
    std::string text = file.string();
    std::replace(text.begin(), text.end(), '\\', '/');
    fs::path found;
    for (const fs::path& part : fs::path(text)) {
        if (part == ".") continue;
        const fs::path folder = found.empty() ? fs::path(".") : found;
        if (part == ".." || part.has_root_directory() || is_there(folder / part)) {
            found /= part;
            continue;
        }
        // Replacing backslashes may have changed where the path leads.
        check_inside(folder);
        const Names& names = names_in(folder);
        const auto name = names.find(lower(part.string()));
        if (name == names.end()) return file;
        found /= name->second;
    }
    check_inside(found);
    return found;
}

InputFile LoadContext::open(const fs::path& file)
{
    // The scene file itself is never confined: the user named it, and it may be a symbolic link.
    InputFile opened(files_.empty() ? file : locate(file));
    add_file(opened.name());
    return opened;
}

std::string LoadContext::read(const fs::path& file)
{
    return open(file).take();
}

}  // namespace fathom
