// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace fathom {

/// Purpose of a ray.
enum class RayKind : std::uint32_t {
    camera,  ///< From the camera to the first surface.
    bounce,  ///< From a scattering event to the next surface.
    shadow   ///< Visibility test of next event estimation.
};
/// Number of values of RayKind.
inline constexpr std::size_t ray_kind_count = 3;

/// Part of the path tracing loop, for time measurements.
enum class RenderStage : std::uint32_t {
    camera,    ///< Generation of camera rays.
    trace,     ///< Nearest intersections of camera and bounce rays.
    arrival,   ///< Emission of surfaces and environment that rays reach, media, and AOVs.
    sort,      ///< Sorting of paths by closure and material.
    surface,   ///< Position, normals and texture coordinates of hits.
    material,  ///< Material parameters, including texture lookups.
    light,     ///< Light selection, light sampling and multiple importance sampling weights.
    scatter,   ///< BSDF sampling and Russian roulette.
    shadow,    ///< Shadow rays.
    film,      ///< Addition of samples to the film.
    learn,     ///< Learning of the guiding distributions.
};
/// Number of values of RenderStage.
inline constexpr std::size_t render_stage_count = 11;

/// Counters and times of a render.
struct RenderCosts {
    std::array<std::uint64_t, ray_kind_count> rays{};  ///< Number of rays by RayKind.
    std::uint64_t clear_shadow_rays = 0;               ///< Number of shadow rays that were not blocked.
    std::uint64_t vertices = 0;                        ///< Number of scattering events on surfaces.
    std::uint64_t light_samples = 0;                   ///< Number of scattering events at which a light was sampled.
    std::uint64_t shaded_lanes = 0;  ///< Number of SIMD lanes that shaded scattering events, idle ones included.
    /// Seconds by RenderStage, summed over all threads; 0 unless RenderSettings::measure_stages is set.
    std::array<double, render_stage_count> seconds{};

    /// Returns the number of rays of all kinds.
    std::uint64_t all_rays() const
    {
        std::uint64_t sum = 0;
        for (std::uint64_t n : rays) sum += n;
        return sum;
    }
    /// Adds counters and times.
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
