// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "guiding/records.h"

namespace fathom {

/// Makes guiding tables of the records, without roulette factors and with shares of 0; returns nullptr if there are too
/// few records.
std::shared_ptr<GuidingTables> make_guiding(const std::vector<const GuidingRecords*>& parts);

/// Replaces the histograms of tables by those of other records. Regions and limits stay as they are.
void learn_histograms(const std::vector<const GuidingRecords*>& parts, GuidingTables& tables);

/// Index of a record's region in GuidingTables::regions.
inline std::size_t region_index(const GuidingRecord& r, const GuidingTables& t)
{
    return guiding_cube(t, r.position) * guiding_sides + r.side;
}

/// Smooths sums over neighboring regions: half of each region's value becomes the mean of its side over a block of
/// eight cubes. This reduces the noise of regions whose sums depend on few bright records.
///
/// counts  number of records per region
/// sums    `stride` values per region
void share_with_neighbors(const GuidingTables& t, const std::vector<std::uint32_t>& counts, std::size_t stride,
                          std::vector<double>& sums);

}  // namespace fathom
