// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interface between the library and the kernel library, which is compiled once per instruction set. Only tables, sums,
/// counters and an opaque scene cross it; no inline code that depends on the instruction set does.
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "fathom/api.h"
#include "fathom/bvh_quality.h"
#include "fathom/costs.h"
#include "film/tile_sums.h"
#include "guiding/records.h"
#include "kernel/camera_record.h"
#include "kernel/caustic_map.h"
#include "kernel/path_profile.h"
#include "kernel/tables.h"
#include "lights/targets.h"

namespace fathom {

/// A scene prepared for rendering: acceleration structure and tables laid out for lanes.
class KernelScene {
public:
    virtual ~KernelScene() = default;
    /// Memory of the acceleration structure and of derived tables, in bytes.
    virtual std::size_t memory_bytes() const = 0;
    /// Whether rays traverse a BVH. Small scenes are a flat list of primitives instead, which takes a third of the
    /// time.
    virtual bool has_tree() const = 0;
    /// Whether scenes of quads alone are rendered by a loop of their own, which takes a third of the time and does
    /// without light tracing.
    virtual bool has_quad_loop() const = 0;
    /// Updates the scene after its tables changed: materials, lights, moving instances, and the vertices of `shapes`,
    /// which must be shapes that are only visible through instances.
    virtual void update(const std::vector<std::uint32_t>& shapes) = 0;
    /// Disables the loop for scenes of quads until the next update(), so that tests and benchmarks can compare both
    /// loops. They have the same estimator, but other random numbers.
    virtual void force_general_loop() = 0;
};

/// Radiance that camera rays see when they miss the scene, in place of the environment.
struct KernelBackground {
    bool given = false;
    Rgb radiance{};
};

/// Render settings that the kernel needs. max_depth: number of surfaces a path may scatter at, -1: no limit.
/// roulette_depth: bounces before Russian roulette.
struct KernelSettings {
    int width = 0, height = 0;
    std::uint32_t seed = 0;
    int max_depth = -1, roulette_depth = 5;
    bool light_sampling = true;
    LightSelection light_selection = LightSelection::tree;
    bool measure = false;  ///< whether KernelCounters::ticks are measured
    /// Limit per channel on what a sample contributes by two or more surfaces; 0: no limit.
    float clamp_indirect = 0;
    std::uint32_t filter = 0;  ///< a value of enum Filter
    float filter_stretch = 1;  ///< factor on the filter's own width
    AovPlaces aovs;
    KernelBackground background;
    const GuidingTables* guiding = nullptr;  ///< guides directions and Russian roulette if not null
    std::size_t film_words = 0;              ///< 32-bit words of a pixel in the film
    /// Light paths per sample index of the whole image (trace_light_paths); 0: no light tracing. The path tracer then
    /// weights what it finds against what light tracing finds.
    std::uint32_t light_paths = 0;
    const LightTargets* light_targets = nullptr;  ///< aims light paths if not null
    /// Photons of caustics for all samples of the job, if not null: camera paths that light tracing cannot find gather
    /// them, and leave out what they stand for. Requires light_paths.
    const CausticMap* caustics = nullptr;
    /// Bit y * width + x: whether a camera ray of the pixel may meet something (pixels_with_surfaces); null: unknown.
    const std::uint32_t* seen_pixels = nullptr;

    /// Whether light sampling is skipped at some vertices by chance: see PathPool::nee_probability.
    bool skips_light_samples() const { return guiding && !guiding->nee_factors.empty(); }
};

/// Limits of a job: pixels, and samples over all its pixels.
inline constexpr std::uint32_t max_job_pixels = 1u << 14, max_job_samples = 1u << 20;
/// Work item of one thread: samples [first_sample, first_sample + samples) of some pixels.
struct KernelJob {
    const std::uint32_t* pixels = nullptr;  ///< one word for each pixel: x in the low 16 bits, y above
    std::uint32_t pixel_count = 0;
    std::uint32_t first_sample = 0, samples = 0;  ///< range of samples, for each pixel
    GuidingRecords* records = nullptr;            ///< receives training data for path guiding if not null
    PathProfile* profile = nullptr;               ///< receives what paths contribute and cost if not null
};

/// Work item of light tracing: light paths [first, first + count) of one sample index.
struct LightPathJob {
    std::uint32_t sample = 0;
    std::uint32_t first = 0, count = 0;
};

/// Russian roulette ends connections of light paths to the camera with a probability that is proportional to their
/// weight against path tracing below this one.
inline constexpr float weight_of_sure_connection = 0.1f;

/// Light that a light path brings to a pixel, to be added to a sample of the pixel.
struct LightSplat {
    std::uint32_t pixel;  ///< x in the low 16 bits, y above
    float value[3];
    /// Squared ratio of the density with which path tracing finds the path to that of light tracing; 0: it cannot.
    float path_ratio;
    std::uint32_t path;  ///< number of the light path
};

/// Where a light path comes to its first surface; panes that it passes straight on do not count.
struct LightArrival {
    std::uint32_t path, light;
    Vec3f position, direction;
    float distance;  ///< from the light, or from the border of the scene
    float own_pdf;   ///< EmissionDensity::direction
};

/// Output of trace_light_paths(), which appends to these lists.
struct LightPathResults {
    std::vector<LightSplat> splats;
    bool records_arrivals = false, records_photons = false;
    std::vector<LightArrival> arrivals;  ///< if records_arrivals
    std::vector<CausticPhoton> photons;  ///< if records_photons, in an order that depends on the number of lanes
};

/// Surface that the ray through the center of a pixel meets first. Lengths are in render space.
struct SurfacePoint {
    float distance = std::numeric_limits<float>::infinity();  ///< along the ray; infinite without a hit
    Vec3f position;
    Vec3f normal;  ///< unit; interpolated vertex normal without normal maps, on the side of the camera
    Vec3f place;   ///< the position in the object space of the instance; that in render space without one
    float u = 0, v = 0;
    std::uint32_t primitive = no_index, instance = no_index, object = 0, material = 0;  ///< object: object_id
};
/// An object that the ray of a pixel meets, whether or not another one is in front of it.
struct ObjectOnRay {
    std::uint32_t object, pixel;  ///< object_id, and index of the pixel in its job
};

/// Point at which a texture is evaluated before the scene is compiled.
struct KernelTexturePoint {
    Vec2f uv[2];  ///< both texture coordinate sets; 0 where a mesh has none
    Vec3f position;
    Vec4f vertex_color{1, 1, 1, 1};
};

/// Statistics of rendering, which each job increases.
struct KernelCounters {
    /// The kernel leaves costs.seconds to the caller, which knows the duration of a tick.
    RenderCosts costs;
    /// Time by RenderStage if settings.measure is set, in arbitrary units: use as shares of the total.
    std::array<std::uint64_t, render_stage_count> ticks{};

    void count_rays(RayKind kind, std::uint64_t number) { costs.rays[std::size_t(kind)] += number; }
};

/// Builds the acceleration structure and the derived tables of a scene. level: quality of the BVH.
std::unique_ptr<KernelScene> make_kernel_scene(std::shared_ptr<const SceneTables> tables,
                                               BvhQuality level = BvhQuality::standard);
/// Finds the pixels whose camera rays may meet something, as KernelSettings::seen_pixels. Others see the background, so
/// that their rays need not be traced. Empty if that cannot be known or would save little.
std::vector<std::uint32_t> pixels_with_surfaces(const KernelScene& scene, const CameraRecord& camera,
                                                const KernelSettings& settings);
/// Renders a job and adds its samples to `sums`, indexed by the position of the pixel in job.pixels.
void render_job(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                const KernelJob& job, TileSums& sums, KernelCounters& counters);
/// Traces light paths, connects their vertices to the camera, and appends what they bring to `results`.
void trace_light_paths(const KernelScene& scene, const CameraRecord& camera, const KernelSettings& settings,
                       const LightPathJob& job, LightPathResults& results, KernelCounters& counters);
/// Traces one ray through the center of each pixel, at the middle of the shutter interval and from the middle of the
/// lens. Alpha of 0.5 or more counts as opaque. Results do not depend on the number of lanes.
///
/// pixels   x in the low 16 bits, y above
/// points   receives the first surface of each pixel
/// objects  if not null, all objects that each ray meets are appended
void trace_pixel_centers(const KernelScene& scene, const CameraRecord& camera, int width, int height,
                         const std::vector<std::uint32_t>& pixels, SurfacePoint* points,
                         std::vector<ObjectOnRay>* objects);
/// Finds where surface points of another state of a scene, whose primitives and instances are the same, are in this
/// one: render-space positions at a time. Points on primitives that are neither triangles nor instanced keep `place`.
void move_surface_points(const SceneTables& tables, float time, const SurfacePoint* points, std::size_t count,
                         Vec3f* positions);
/// Evaluates one channel of a texture at `count` points by the code that shading uses.
void look_up_texture(const ShadingTables& tables, std::uint32_t texture, std::uint32_t channel,
                     const KernelTexturePoint* points, std::size_t count, float* values);
/// Number of lanes, and name of the instruction set.
int kernel_lanes();
const char* kernel_name();

/// Functions of a kernel library, which it exports as `fathom_kernel`. libfathom has functions with the names and types
/// above that call these (src/kernel/library).
struct KernelFunctions {
    const char* version;  ///< version of Fathom
    decltype(fathom::make_kernel_scene)* make_kernel_scene;
    decltype(fathom::pixels_with_surfaces)* pixels_with_surfaces;
    decltype(fathom::render_job)* render_job;
    decltype(fathom::trace_light_paths)* trace_light_paths;
    decltype(fathom::trace_pixel_centers)* trace_pixel_centers;
    decltype(fathom::move_surface_points)* move_surface_points;
    decltype(fathom::look_up_texture)* look_up_texture;
    decltype(kernel_lanes)* lanes;
    decltype(kernel_name)* name;
};

}  // namespace fathom
