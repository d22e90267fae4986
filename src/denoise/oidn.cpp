// SPDX-License-Identifier: Apache-2.0
#include "denoise/oidn.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "base/dynamic_library.h"
#include "fathom/error.h"

namespace fathom {

namespace {

namespace fs = std::filesystem;

constexpr const char* variable = "FATHOM_OIDN";
constexpr const char* soname = "libOpenImageDenoise.so.2";

std::string environment(const char* name)
{
    const char* value = std::getenv(name);
    return value ? value : "";
}

/// Installation prefixes that may have Python packages in lib/python3.x.
std::vector<fs::path> python_prefixes()
{
    std::vector<fs::path> prefixes;
    if (const std::string venv = environment("VIRTUAL_ENV"); !venv.empty()) prefixes.emplace_back(venv);
    std::istringstream path(environment("PATH"));
    for (std::string folder; std::getline(path, folder, ':');)
        if (!folder.empty()) prefixes.push_back(fs::path(folder).parent_path());
    if (const std::string home = environment("HOME"); !home.empty()) prefixes.push_back(fs::path(home) / ".local");
    return prefixes;
}

/// Paths of the library in the pip package pyoidn, found without running Python.
std::vector<fs::path> python_places()
{
    std::vector<fs::path> found;
    for (const fs::path& prefix : python_prefixes()) {
        std::error_code error;
        std::vector<fs::path> versions;
        for (fs::directory_iterator entry(prefix / "lib", error), end; !error && entry != end; entry.increment(error))
            if (entry->path().filename().string().starts_with("python3")) versions.push_back(entry->path());
        std::sort(versions.begin(), versions.end());
        for (const fs::path& version : versions)
            for (const char* packages : {"site-packages", "dist-packages"}) {
                const fs::path file = version / packages / "pyoidn/oidn/lib" / soname;
                if (fs::exists(file, error)) found.push_back(file);
            }
    }
    return found;
}

/// Loads the library's functions; throws Error if one is missing.
Oidn load_functions(void* library, const fs::path& file)
{
    Oidn oidn{};
    oidn.file = file;
    const auto load_symbol = [&](auto& function, const char* name) {
        load_function(library, file.string(), "Open Image Denoise 2", name, function);
    };
    load_symbol(oidn.oidnNewDevice, "oidnNewDevice");
    load_symbol(oidn.oidnReleaseDevice, "oidnReleaseDevice");
    load_symbol(oidn.oidnSetDeviceInt, "oidnSetDeviceInt");
    load_symbol(oidn.oidnSetDeviceBool, "oidnSetDeviceBool");
    load_symbol(oidn.oidnGetDeviceInt, "oidnGetDeviceInt");
    load_symbol(oidn.oidnCommitDevice, "oidnCommitDevice");
    load_symbol(oidn.oidnGetDeviceError, "oidnGetDeviceError");
    load_symbol(oidn.oidnNewFilter, "oidnNewFilter");
    load_symbol(oidn.oidnReleaseFilter, "oidnReleaseFilter");
    load_symbol(oidn.oidnSetSharedFilterImage, "oidnSetSharedFilterImage");
    load_symbol(oidn.oidnSetFilterBool, "oidnSetFilterBool");
    load_symbol(oidn.oidnSetFilterInt, "oidnSetFilterInt");
    load_symbol(oidn.oidnSetFilterProgressMonitorFunction, "oidnSetFilterProgressMonitorFunction");
    load_symbol(oidn.oidnCommitFilter, "oidnCommitFilter");
    load_symbol(oidn.oidnExecuteFilter, "oidnExecuteFilter");
    return oidn;
}

void* open_library(const fs::path& file)
{
    return dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
}

Oidn open_named(const std::string& name)
{
    fs::path file = name;
    std::error_code error;
    if (fs::is_directory(file, error)) file /= fs::exists(file / soname, error) ? soname : fs::path("lib") / soname;
    if (!fs::exists(file, error)) throw Error(file.string(), variable, "there is no such library");
    // A name without a folder would be searched for among the system's libraries.
    void* library = open_library(fs::absolute(file, error));
    if (!library) throw Error(file.string(), variable, "can't be opened: " + dynamic_library_error());
    return load_functions(library, file);
}

}  // namespace

Oidn open_oidn()
{
    if (const std::string name = environment(variable); !name.empty()) return open_named(name);
    if (void* library = open_library(soname)) return load_functions(library, soname);
    std::string reason;
    for (const fs::path& file : python_places()) {
        if (void* library = open_library(file)) return load_functions(library, file);
        reason = fmt::format(" ({})", dynamic_library_error());
    }
    throw Error("", "denoising",
                fmt::format("Open Image Denoise 2 was not found{}: `pip install pyoidn` provides it, or give the path "
                            "of its {} in the environment variable {}",
                            reason, soname, variable));
}

}  // namespace fathom
