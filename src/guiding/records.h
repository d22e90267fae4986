// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Path guiding: what training passes record about incident light by position and direction.
///
/// Space is divided into cubes, and each cube into six regions by the axis direction that surfaces face: +x, -x, +y,
/// -y, +z or -z. A region has a histogram over directions whose pole is that axis direction. Its bands have equal
/// height, hence equal solid angle, and are divided into sectors. See Mueller, Gross and Novak 2017, "Practical Path
/// Guiding for Efficient Light-Transport Simulation", for what to learn and how to use it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/large_memory.h"
#include "base/no_index.h"

namespace fathom {

inline constexpr std::uint32_t guiding_sides = 6;
inline constexpr std::uint32_t guiding_bands = 8, guiding_sectors = 16, guiding_bins = guiding_bands * guiding_sectors;
/// Number of values of a region's cumulative histogram, which ascend from 0 to 1.
inline constexpr std::uint32_t guiding_stride = guiding_bins + 1;

/// Learned tables for the scene as seen by a camera.
struct GuidingTables {
    float lowest[3] = {};  ///< corner of the first cube, in render space
    float inverse_cell = 0;
    /// Number of cubes along x, y and z; points beyond the grid belong to the cubes at its border.
    std::uint32_t cells[3] = {};
    LargeVector<std::uint32_t> regions;  ///< region index by (cube, x fastest) * guiding_sides + side, or no_index
    LargeVector<float> histograms;       ///< cumulative histograms, guiding_stride values per region
    /// Indexed by region: fraction of directions to sample from the histogram, where closures can be guided fully.
    LargeVector<float> shares;
    double max_value = 0;  ///< upper limit that was applied to record values
    /// Indexed by region: survival probability of a path divided by expected_throughput(); see
    /// session/efficiency_roulette.h.
    LargeVector<float> survival_factors;
    /// Indexed by cube: probability of sampling a light divided by the throughput; see session/efficiency_roulette.h.
    /// If empty, lights are always sampled.
    LargeVector<float> nee_factors;
    /// Indexed by cube: probability of tracing a shadow ray divided by the contribution of its light sample if
    /// unoccluded. If empty, shadow rays are always traced.
    LargeVector<float> shadow_ray_factors;
};

/// Index of the cube that contains a position.
inline std::size_t guiding_cube(const GuidingTables& t, const float* position)
{
    std::size_t at[3];
    for (std::size_t k = 0; k < 3; ++k)
        at[k] = std::size_t(std::clamp((position[k] - t.lowest[k]) * t.inverse_cell, 0.f, float(t.cells[k] - 1)));
    return (at[2] * t.cells[1] + at[1]) * t.cells[0] + at[0];
}

/// Record of a path vertex on a surface that scattered the path. Colors are means of their channels.
struct GuidingRecord {
    static constexpr std::uint16_t no_bin = 0xffff;
    /// Value of `guidable` for closures that can be guided fully.
    static constexpr std::uint8_t fully_guidable = 255;

    float position[3];
    std::uint8_t side = 0;
    std::uint8_t guidable = 0;   ///< the closure's guided_weight(), times fully_guidable
    std::uint16_t bin = no_bin;  ///< histogram bin of the outgoing direction, or no_bin
    /// Incident radiance along that direction times its cosine, divided by the density with which it was sampled.
    float value = 0;
    /// Contribution of the vertex's light sample, divided by the throughput of the path.
    float light = 0;
    /// Contribution of the outgoing direction to the radiance of the path.
    float contribution = 0;
    /// Throughput that roulette expects after scattering: expected_throughput().
    float throughput = 0;
    /// Density of the outgoing direction by the closure alone, with respect to solid angle.
    float bsdf_pdf = 0;
};

/// Records of training paths, path by path.
struct GuidingRecords {
    std::vector<GuidingRecord> surfaces;
    std::vector<std::uint8_t> counts;  ///< number of surface records of each path
    std::vector<float> radiance;       ///< radiance of each path; mean of the channels
};

}  // namespace fathom
