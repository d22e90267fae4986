#pragma once
/// What is worth its time: chances with which paths sample a light where they are, and with which they go on. With
/// them the noise that either adds, and the time that it takes, are in balance with noise and time of the whole: the
/// chance is a path's throughput times the root of (the mean square of what it brings over the vertices that this
/// takes), over the same of whole paths (Rath et al. 2022, "EARS: Efficiency-Aware Russian Roulette and Splitting").
/// What paths bring counts beside how bright their pixels are.
#include <vector>

#include "guiding/records.h"

namespace fathom {

/// What a light sample takes, with its shadow ray, of all that a vertex takes; measured.
inline constexpr double light_cost = 0.25;

/// What paths met, and what they take and bring on average.
struct PathsMet {
    struct Part {
        const GuidingRecords* records;
        const double* brightness_squares;  ///< by pixel, `samples` of whose paths follow each other
    };
    std::vector<Part> parts;
    std::size_t samples = 0;  ///< of each pixel
    double vertices = 0;      ///< of a path
    double variance = 0;      ///< of a path, over the square of the brightness of its pixel
};

/// Sets the tables' nee_factors.
void set_nee_factors(const PathsMet& met, GuidingTables& tables);
/// Sets the tables' shadow_ray_factors.
void set_shadow_ray_factors(const PathsMet& met, GuidingTables& tables);
/// Sets the tables' survival_factors.
void set_survival_factors(const PathsMet& met, GuidingTables& tables);

}  // namespace fathom
