// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Efficiency-aware Russian roulette (Rath et al. 2022, "EARS: Efficiency-Aware Russian Roulette and Splitting"): the
/// probabilities of next event estimation and of path continuation that minimize variance times cost. A probability is
/// the throughput times the root of (second moment of the contribution over its cost in vertices), divided by the root
/// of the same ratio for whole paths. Contributions are relative to the brightness of their pixels.
#include "session/path_statistics.h"

namespace fathom {

/// Measured cost of a light sample with its shadow ray, as a fraction of the cost of a vertex.
inline constexpr double nee_cost = 0.25;

/// Sets GuidingTables::nee_factors.
void set_nee_factors(const PathStatistics& met, GuidingTables& tables);
/// Sets GuidingTables::shadow_ray_factors.
void set_shadow_ray_factors(const PathStatistics& met, GuidingTables& tables);
/// Sets GuidingTables::survival_factors.
void set_survival_factors(const PathStatistics& met, GuidingTables& tables);

}  // namespace fathom
