// SPDX-License-Identifier: Apache-2.0
#include "formats/fathom/save_files.h"

#include <fmt/format.h>

#include "fathom/error.h"
#include "formats/json/json.h"

namespace fathom {

namespace fs = std::filesystem;

namespace {

/// The text with invalid UTF-8 replaced by U+FFFD.
std::string utf8(const std::string& text)
{
    return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

std::string plain(std::string name)
{
    constexpr std::size_t longest = 60;
    for (char& c : name)
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-'))
            c = '_';
    return name.substr(0, longest);
}

fs::path folder_of(const fs::path& file)
{
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

std::string UniqueNames::add(const std::string& wanted, const std::string& other)
{
    std::string name = wanted.empty() ? other : utf8(wanted);
    if (used_.try_emplace(name, 1).second) return name;
    for (;;)
        if (std::string numbered = fmt::format("{} {}", name, ++used_[name]); used_.try_emplace(numbered, 1).second)
            return numbered;
}

SaveFiles::SaveFiles(const SceneDescription& scene, const fs::path& target) : scene_(scene), target_(target)
{
    folder_ = folder_of(target) / (target.stem().string() + "-files");
    if (const std::string name = folder_.filename().string(); utf8(name) != name)
        folder_ = folder_of(target) / "scene-files";
}

std::string SaveFiles::add(const std::string& name, const std::string& extension, Write write)
{
    files_.emplace_back(folder_ / (plain(name) + extension), std::move(write));
    return (folder_.filename() / files_.back().first.filename()).string();
}

std::string SaveFiles::refer(const fs::path& file) const
{
    // Only the folder is resolved: if the file itself is a link, its own name is kept.
    std::error_code error;
    const fs::path real = fs::weakly_canonical(folder_of(file), error) / file.filename();
    const fs::path from = error ? fs::path() : fs::weakly_canonical(folder_of(target_), error);
    const fs::path relative = error ? fs::path() : real.lexically_relative(from);
    const std::string text = (relative.empty() ? fs::absolute(file, error) : relative).string();
    return utf8(text) == text ? text : std::string();
}

void SaveFiles::check(const fs::path& file) const
{
    const auto is_same = [&](const fs::path& input) {
        std::error_code error;
        return fs::equivalent(file, input, error) && !error;
    };
    bool is_input = is_same(scene_.file);
    for (const fs::path& input : scene_.files) is_input = is_input || is_same(input);
    for (const ImageFile& image : scene_.images) is_input = is_input || (!image.path.empty() && is_same(image.path));
    if (is_input) throw Error(file.string(), "", "the scene was read from this file: choose another name");
}

void SaveFiles::write() const
{
    std::error_code error;
    if (fs::exists(target_, error)) check(target_);
    if (files_.empty()) return;
    if (fs::exists(folder_, error))
        for (const auto& [file, write] : files_)
            if (fs::exists(file, error)) check(file);
    fs::create_directory(folder_, error);
    if (error) throw Error(folder_.string(), "", fmt::format("can't create this folder: {}", error.message()));
    for (const auto& [file, write] : files_) write(file);
}

}  // namespace fathom
