// SPDX-License-Identifier: Apache-2.0
#include "process/modules.h"

#include <cstring>
#include <filesystem>

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

/// Path of a library; empty if it is not installed.
fs::path find_library(const char* file)
{
    std::error_code error;
    const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (const fs::path& libraries : {folder, folder / ".." / "lib", folder / ".." / FATHOM_LIBDIR})
        if (fs::exists(libraries / file, error)) return libraries / file;
    return {};
}

}  // namespace

void* open_module(const char* file, const char* version_symbol, const std::string& missing, bool global)
{
    const fs::path path = find_library(file);
    if (path.empty()) throw Error("", "", missing);
    void* const module = dlopen(path.c_str(), RTLD_NOW | (global ? RTLD_GLOBAL : RTLD_LOCAL));
    if (!module) throw Error("", "", fmt::format("the module {} can't be loaded: {}", file, dlerror()));
    const auto version = static_cast<const char* const*>(dlsym(module, version_symbol));
    if (!version || std::strcmp(*version, FATHOM_VERSION) != 0)
        throw Error(path.string(), "", "belongs to another version of Fathom");
    return module;
}

bool has_module(const char* file)
{
    return !find_library(file).empty();
}

}  // namespace fathom::cli
