#pragma once
/// Path guiding: what a first look at a scene tells about where light comes from, by place and by direction.
///
/// Space is cut into cubes, and each of them into six regions, by the side that surfaces face: along +x, -x, +y, -y, +z
/// or -z. A region has a histogram over directions whose pole is that side's: bands of equal height, hence of equal
/// solid angle, cut into sectors. See Mueller, Gross and Novak 2017, "Practical Path Guiding for Efficient
/// Light-Transport Simulation", for what to learn and how to use it.
#include <cstdint>
#include <vector>

#include "math/memory.h"
#include "math/no_index.h"

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
    /// By region: radiance that comes back along directions that surfaces choose, averaged over them by the cosine;
    /// without what light samples bring.
    LargeVector<float> means;
};

/// A direction that a path took from a surface, and what came back along it.
struct GuidingRecord {
    float position[3];
    std::uint16_t side = 0, bin = 0;
    /// Radiance times the cosine over the density with which the direction was sampled: the mean of the channels.
    float value = 0;
};

/// What paths that are traced for learning met and brought, pixel by pixel and sample by sample.
struct GuidingRecords {
    std::vector<GuidingRecord> turns;
    std::vector<float> radiance;  ///< of each path: the mean of the channels
};

}  // namespace fathom
