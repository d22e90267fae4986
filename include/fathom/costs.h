#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace fathom {

/// Why a ray is traced.
enum class RayKind : std::uint32_t { camera, bounce, shadow };
inline constexpr std::size_t ray_kind_count = 3;

/// What a thread is at while it renders.
enum class RenderStage : std::uint32_t {
    camera,    ///< makes paths
    trace,     ///< nearest hits of the camera's rays and of bounces
    arrival,   ///< what surfaces and the environment send to the paths that meet them; media; layers of the film
    sort,      ///< brings paths that go on into the order of closures and materials
    surface,   ///< position and normals of hits
    material,  ///< parameters, with their textures
    light,     ///< chooses a light and a point of it, and weighs it
    scatter,   ///< the next direction, roulette
    shadow,    ///< shadow rays
    film,      ///< adds samples up
    quads,     ///< all of these at once: the loop for rooms of diffuse quads
    learn,     ///< learns where light comes from
};
inline constexpr std::size_t render_stage_count = 12;

/// What a rendering has taken.
struct RenderCosts {
    std::array<std::uint64_t, ray_kind_count> rays{};  ///< by RayKind
    std::uint64_t clear_shadow_rays = 0;               ///< those that nothing blocked
    std::uint64_t vertices = 0;                        ///< places where paths were scattered by surfaces
    std::uint64_t light_samples = 0;                   ///< at how many of these a light was sampled
    std::uint64_t shaded_lanes = 0;                    ///< lanes, idle ones too, that shading them took
    /// Seconds of all threads, by RenderStage; 0 unless RenderSettings::measure.
    std::array<double, render_stage_count> seconds{};

    std::uint64_t all_rays() const
    {
        std::uint64_t sum = 0;
        for (std::uint64_t n : rays) sum += n;
        return sum;
    }
    RenderCosts& operator+=(const RenderCosts& o)
    {
        for (std::size_t i = 0; i < rays.size(); ++i) rays[i] += o.rays[i];
        clear_shadow_rays += o.clear_shadow_rays, vertices += o.vertices, shaded_lanes += o.shaded_lanes;
        light_samples += o.light_samples;
        for (std::size_t i = 0; i < seconds.size(); ++i) seconds[i] += o.seconds[i];
        return *this;
    }
};

}  // namespace fathom
