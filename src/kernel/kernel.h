#pragma once
/// The boundary between the library and the kernel library, which exists once per instruction set. Tables, sums and
/// counters cross it, and a scene that only the kernel that made it looks into; no code compiled for one instruction
/// set.
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fathom/costs.h"
#include "fathom/export.h"
#include "fathom/tree_build.h"
#include "film/tile_sums.h"
#include "guiding/records.h"
#include "kernel/camera_record.h"
#include "kernel/tables.h"

namespace fathom {

/// A scene made ready for the kernel: acceleration structures and tables laid out for lanes.
class KernelScene {
public:
    virtual ~KernelScene() = default;
    virtual std::size_t memory_bytes() const = 0;
    /// Rays go through a tree, not by all primitives of a small scene, which takes a third of the time.
    virtual bool has_tree() const = 0;
    /// Brings it up to date after its tables have changed: materials, lights, instances that are not still, and the
    /// vertices of `shapes` that only instances show.
    virtual void update(const std::vector<std::uint32_t>& shapes) = 0;
};

/// What the camera sees where there is nothing, instead of the environment.
struct KernelBackground {
    bool given = false;
    Rgb radiance{};
};

struct KernelSettings {
    int width = 0, height = 0;
    std::uint32_t seed = 0;
    int max_depth = -1, roulette_depth = 5;
    bool light_sampling = true;
    LightSelection light_selection = LightSelection::tree;
    bool general_loop = false;  ///< rooms of quads, too, are rendered by the loop for all scenes
    bool measure = false;       ///< KernelCounters::ticks
    /// Of what a sample brings by two surfaces or more, in each channel; 0: as much as there is.
    float clamp_indirect = 0;
    std::uint32_t filter = 0;  ///< Filter
    float filter_stretch = 1;  ///< how many times as wide it is as by itself
    AovPlaces aovs;
    KernelBackground background;
    const GuidingTables* guiding = nullptr;  ///< directions and roulette go by it, where there is one
    std::size_t film_words = 0;              ///< 32-bit words of a pixel in the film

    /// Paths don't sample a light at every surface: see PathPool::light_chance.
    bool skips_light_samples() const { return guiding && !guiding->nee_factors.empty(); }
};

/// Samples first_sample and on of some pixels: at most max_job_pixels, and max_job_samples in all.
inline constexpr std::uint32_t max_job_pixels = 1u << 14, max_job_samples = 1u << 20;
struct KernelJob {
    const std::uint32_t* pixels = nullptr;  ///< x in the low 16 bits, y above, of each
    std::uint32_t pixel_count = 0;
    std::uint32_t first_sample = 0, samples = 0;  ///< of each pixel
    GuidingRecords* records = nullptr;            ///< gets what the paths met, where that is wanted
};

/// Where a texture is looked up before there is a scene to render.
struct KernelTexturePoint {
    Vec2f uv[2];  ///< the two sets; 0 where a mesh has none
    Vec3f position;
    Vec4f vertex_color{1, 1, 1, 1};
};

struct KernelCounters {
    /// `seconds` is left to whoever knows how long a tick is.
    RenderCosts costs;
    /// Time by RenderStage where settings.measure asks for it: shares of the whole, of no unit.
    std::array<std::uint64_t, render_stage_count> ticks{};

    void count_rays(RayKind kind, std::uint64_t number) { costs.rays[std::size_t(kind)] += number; }
};

FATHOM_API std::unique_ptr<KernelScene> make_kernel_scene(std::shared_ptr<const SceneTables> tables,
                                                          TreeBuild level = TreeBuild::standard);
/// Adds the job's samples to `sums`, indexed by the position of the pixel in job.pixels.
FATHOM_API void render_job(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                           const KernelJob& job, TileSums& sums, KernelCounters& counters);
/// One channel of a texture at some points, by the code that shades.
FATHOM_API void look_up_texture(const ShadingTables& tables, std::uint32_t texture, std::uint32_t channel,
                                const KernelTexturePoint* points, std::size_t count, float* values);
FATHOM_API int kernel_lanes();
FATHOM_API const char* kernel_name();

}  // namespace fathom
