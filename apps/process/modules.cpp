#include "process/modules.h"

#include <cstring>
#include <filesystem>

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

/// Where the module is; empty: nowhere.
fs::path place_of(const char* file)
{
    std::error_code error;
    const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (const fs::path& place : {folder, folder / ".." / "lib", folder / ".." / FATHOM_LIBDIR})
        if (fs::exists(place / file, error)) return place / file;
    return {};
}

}  // namespace

void* open_module(const char* file, const char* version_symbol, const std::string& missing, bool global)
{
    const fs::path place = place_of(file);
    if (place.empty()) throw Error("", "", missing);
    void* const module = dlopen(place.c_str(), RTLD_NOW | (global ? RTLD_GLOBAL : RTLD_LOCAL));
    if (!module) throw Error("", "", fmt::format("the module {} can't be used: {}", file, dlerror()));
    const auto version = static_cast<const char* const*>(dlsym(module, version_symbol));
    if (!version || std::strcmp(*version, FATHOM_VERSION) != 0)
        throw Error(place.string(), "", "belongs to another version of Fathom");
    return module;
}

bool has_module(const char* file)
{
    return !place_of(file).empty();
}

}  // namespace fathom::cli
