// SPDX-License-Identifier: Apache-2.0
/// Opens a kernel library when the first function of the kernel is called, and implements kernel.h by its functions.
#include <link.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "base/dynamic_library.h"
#include "fathom/error.h"
#include "fathom/render.h"
#include "kernel/kernel.h"
#include "kernel/library/selection.h"

namespace fathom {

namespace fs = std::filesystem;

namespace {

/// Folder of the library that contains this code, or of the program if they are linked statically.
fs::path own_folder()
{
    static const char marker = 0;
    Dl_info info{};
    void* map = nullptr;
    std::error_code error;
    fs::path file;
    if (dladdr1(&marker, &info, &map, RTLD_DL_LINKMAP)) file = static_cast<link_map*>(map)->l_name;
    if (file.empty()) file = "/proc/self/exe";  // the loader knows programs by the word that started them
    return fs::canonical(file, error).parent_path();
}

/// Folder of the kernel libraries. Programs that link parts of libfathom statically, such as tests, are in bin.
fs::path kernel_folder()
{
    const fs::path own = own_folder();
    std::error_code error;
    const fs::path beside_bin = own / ".." / "lib" / "fathom";
    return fs::is_directory(own / "fathom", error) || !fs::is_directory(beside_bin, error) ? own / "fathom"
                                                                                           : beside_bin;
}

struct OpenKernel {
    KernelChoice choice;
    const KernelFunctions* functions = nullptr;
};

OpenKernel open_kernel()
{
    const fs::path folder = kernel_folder();
    std::array<bool, kernel_levels.size()> installed{};
    std::error_code error;
    for (std::size_t level = 0; level < kernel_levels.size(); ++level)
        installed[level] = fs::exists(folder / kernel_levels[level].file, error);
    const char* const requested = std::getenv("FATHOM_KERNEL");
    OpenKernel kernel{select_kernel(supported_kernel_level(), requested ? requested : "", installed, folder.string()),
                      nullptr};

    const std::string file = (folder / ("libfathom_kernel-" + kernel.choice.name + ".so")).string();
    void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) throw Error("", "", "the kernel can't be opened: " + dynamic_library_error());
    load_function(library, file, "a kernel of Fathom", "fathom_kernel", kernel.functions);
    if (std::string(kernel.functions->version) != FATHOM_VERSION)
        throw Error(file, "", "belongs to another version of Fathom");
    return kernel;
}

const OpenKernel& kernel()
{
    static const OpenKernel opened = open_kernel();
    return opened;
}

}  // namespace

std::unique_ptr<KernelScene> make_kernel_scene(std::shared_ptr<const SceneTables> tables, BvhQuality level)
{
    return kernel().functions->make_kernel_scene(std::move(tables), level);
}

std::vector<std::uint32_t> pixels_with_surfaces(const KernelScene& scene, const CameraRecord& camera,
                                                const KernelSettings& settings)
{
    return kernel().functions->pixels_with_surfaces(scene, camera, settings);
}

void render_job(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                const KernelJob& job, TileSums& sums, KernelCounters& counters)
{
    kernel().functions->render_job(scene, camera, settings, job, sums, counters);
}

void trace_light_paths(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                       const LightPathJob& job, LightPathResults& results, KernelCounters& counters)
{
    kernel().functions->trace_light_paths(scene, camera, settings, job, results, counters);
}

void trace_pixel_centers(const KernelScene& scene, const CameraRecord& camera, int width, int height,
                         const std::vector<std::uint32_t>& pixels, SurfacePoint* points,
                         std::vector<ObjectOnRay>* objects)
{
    kernel().functions->trace_pixel_centers(scene, camera, width, height, pixels, points, objects);
}

void move_surface_points(const SceneTables& tables, float time, const SurfacePoint* points, std::size_t count,
                         Vec3f* positions)
{
    kernel().functions->move_surface_points(tables, time, points, count, positions);
}

void look_up_texture(const ShadingTables& tables, std::uint32_t texture, std::uint32_t channel,
                     const KernelTexturePoint* points, std::size_t count, float* values)
{
    kernel().functions->look_up_texture(tables, texture, channel, points, count, values);
}

int kernel_lanes()
{
    return kernel().functions->lanes();
}

const char* kernel_name()
{
    return kernel().functions->name();
}

int simd_width()
{
    return kernel_lanes();
}

const char* simd_name()
{
    return kernel_name();
}

KernelChoice kernel_choice()
{
    return kernel().choice;
}

}  // namespace fathom
