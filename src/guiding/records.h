#pragma once
/// Path guiding: what a first look at a scene tells about where light comes from, by place and by direction.
///
/// Space is cut into cubes, and each of them into six regions, by the side that surfaces face: along +x, -x, +y, -y, +z
/// or -z. A region has a histogram over directions whose pole is that side's: bands of equal height, hence of equal
/// solid angle, cut into sectors. See Mueller, Gross and Novak 2017, "Practical Path Guiding for Efficient
/// Light-Transport Simulation", for what to learn and how to use it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/large_memory.h"
#include "base/no_index.h"

namespace fathom {

inline constexpr std::uint32_t guiding_sides = 6;
inline constexpr std::uint32_t guiding_bands = 8, guiding_sectors = 16, guiding_bins = guiding_bands * guiding_sectors;
/// Values of a region's cumulative histogram, from 0 to 1.
inline constexpr std::uint32_t guiding_stride = guiding_bins + 1;

/// What has been learnt of a scene as a camera sees it.
struct GuidingTables {
    float lowest[3] = {};  ///< corner of the first cube, in render space
    float inverse_cell = 0;
    /// Cubes along x, y and z; whatever lies beyond belongs to those at the border.
    std::uint32_t cells[3] = {};
    LargeVector<std::uint32_t> regions;  ///< by (cube, x first) * guiding_sides + side: its number, or no_index
    LargeVector<float> histograms;       ///< guiding_stride values a region
    double max_value = 0;                ///< what a record's value counted at most
    /// By region: with what chance a path goes on from there, over its throughput times the surface's colour; see
    /// session/efficiency_roulette.h.
    LargeVector<float> survival_factors;
    /// By cube: with what chance a path samples a light there, over its throughput; the same. Empty: all do.
    LargeVector<float> nee_factors;
    /// By cube: with what chance the shadow ray of a light sample is traced, over what the sample brings if it arrives.
    LargeVector<float> shadow_ray_factors;
};

/// The number of the cube that a place is in.
inline std::size_t guiding_cube(const GuidingTables& t, const float* position)
{
    std::size_t at[3];
    for (std::size_t k = 0; k < 3; ++k)
        at[k] = std::size_t(std::clamp((position[k] - t.lowest[k]) * t.inverse_cell, 0.f, float(t.cells[k] - 1)));
    return (at[2] * t.cells[1] + at[1]) * t.cells[0] + at[0];
}

/// What a path met at a surface that scatters it.
struct GuidingRecord {
    static constexpr std::uint16_t no_bin = 0xffff;

    float position[3];
    std::uint16_t side = 0, bin = no_bin;  ///< of the direction that the path took from there, if any
    /// Radiance that came back along it, times the cosine over the density with which it was sampled: the mean of the
    /// channels.
    float value = 0;
    /// What a light sample brought there, over the path's throughput: the mean of the channels.
    float light = 0;
};

/// What paths that are traced for learning met and brought, path by path.
struct GuidingRecords {
    std::vector<GuidingRecord> surfaces;
    std::vector<std::uint8_t> counts;  ///< how many of these belong to each path
    std::vector<float> radiance;       ///< of each path: the mean of the channels
};

}  // namespace fathom
