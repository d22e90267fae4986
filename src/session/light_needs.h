#pragma once
#include <vector>

#include "guiding/records.h"

namespace fathom {

/// What a light sample takes, with its shadow ray, of all that a vertex takes; measured.
inline constexpr double light_cost = 0.25;

/// What paths without guidance met, and what they take and bring on average.
struct PathsMet {
    std::vector<const GuidingRecords*> parts;
    std::vector<double> brightness_squares;  ///< by pixel
    std::size_t samples = 0;                 ///< of each pixel, path by path
    double vertices = 0;                     ///< of a path
    double variance = 0;                     ///< of a path, over the square of the brightness of its pixel
};

/// Sets the tables' light_needs. A path samples a light where it is with a chance that is in proportion to its
/// throughput and to what such samples bring there, beside how bright its pixel is: so that the noise that they add,
/// and the time that they take, are in balance with noise and time of the whole (after Rath et al. 2022, "EARS:
/// Efficiency-Aware Russian Roulette and Splitting").
void set_light_needs(const PathsMet& met, GuidingTables& tables);

}  // namespace fathom
