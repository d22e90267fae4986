// SPDX-License-Identifier: Apache-2.0
#include "formats/assimp/open_module.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstring>

#include "fathom/error.h"
#include "formats/assimp/ipc.h"
#include "formats/assimp/module.h"
#include "formats/assimp/subprocess.h"
#include "formats/io/read_file.h"
#include "formats/mesh/mesh_cleanup.h"

namespace fathom {

namespace {

/// The folder of the library or program that contains this code.
std::filesystem::path own_folder()
{
    Dl_info info;
    std::error_code error;
    if (dladdr(reinterpret_cast<const void*>(&own_folder), &info) != 0 && std::strchr(info.dli_fname, '/'))
        return std::filesystem::absolute(info.dli_fname, error).parent_path();
    // For a program found through PATH, dli_fname has no folder.
    return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

/// Opens the module once and keeps it, since Assimp doesn't support unloading. Null if it is missing; `why` then has
/// the reason.
void* open_module(std::string& why)
{
    static std::string reason;
    static void* const handle = [] {
        const std::filesystem::path folder = own_folder();
        for (const std::filesystem::path& place : {folder, folder / ".." / "lib"}) {
            const std::filesystem::path module = place / assimp_module_file;
            std::error_code error;
            if (!std::filesystem::exists(module, error)) continue;
            void* opened = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
            if (!opened) {
                reason = dlerror();
                continue;
            }
            const auto* version = static_cast<const char*>(dlsym(opened, assimp_version_symbol));
            if (version && std::strcmp(version, FATHOM_VERSION) == 0) return opened;
            reason = "it belongs to another version of Fathom";
        }
        return static_cast<void*>(nullptr);
    }();
    why = reason;
    return handle;
}

}  // namespace

SceneDescription read_with_assimp(const std::filesystem::path& file, const LoadOptions& options, LoadContext& context)
{
    const std::string name = file.string();
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
        throw Error(
            name, "",
            "its format can't be detected from the content: give a file whose name has an extension, or --format");
    std::string why;
    void* const module = open_module(why);
    const auto read = module ? reinterpret_cast<AssimpRead>(dlsym(module, assimp_read_symbol)) : nullptr;
    if (!read)
        throw Error(name, "",
                    fmt::format("Fathom has no built-in reader for '{}', and the module {} that reads more formats {}",
                                file.extension().string(), assimp_module_file,
                                why.empty() ? "was not found" : "can't be used: " + printable(why)));
    // Assimp aborts on files that violate its assertions and crashes on others, so it runs in a process of its own.
    const std::size_t megabytes = std::size_t(std::filesystem::file_size(file) >> 20) + 1;
    const SubprocessResult result = run_in_subprocess(
        [&] {
            AssimpAnswer answer;
            read({file, options.up_axis == 0, context.folder()}, answer);
            return to_bytes(answer);
        },
        unsigned(30 + 10 * megabytes), (std::size_t(2) << 30) + megabytes * (std::size_t(200) << 20));
    AssimpAnswer answer;
    if (!result.failure.empty()) throw Error(name, "", fmt::format("Assimp can't read the file: {}", result.failure));
    if (!from_bytes(result.bytes, answer)) throw Error(name, "", "Assimp's answer is truncated");
    if (!answer.error.empty()) throw Error(name, "", printable(answer.error));
    for (const std::string& warning : answer.warnings) context.warnings.add(fmt::format("{}: {}", name, warning));
    for (Mesh& mesh : answer.scene.meshes) {
        for (std::uint32_t index : mesh.indices)
            if (index >= mesh.positions.size())
                throw Error(name, printable(mesh.name), "a vertex index is out of range");
        clean_mesh(mesh, name, context.mesh_faults);
    }
    for (const std::filesystem::path& opened : answer.scene.files) context.add_file(opened);
    answer.scene.files.clear();
    answer.scene.file = name;
    return std::move(answer.scene);
}

}  // namespace fathom
