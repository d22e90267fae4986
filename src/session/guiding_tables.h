#pragma once
#include <memory>
#include <vector>

#include "guiding/records.h"

namespace fathom {

/// The tables of some records, without needs; nullptr where these tell too little.
std::shared_ptr<GuidingTables> make_guiding(const std::vector<const GuidingRecords*>& parts);

/// Where a record's region is in GuidingTables::regions.
inline std::size_t place_of(const GuidingRecord& r, const GuidingTables& t)
{
    return guiding_cube(t, r.position) * guiding_sides + r.side;
}

/// Gives each region half of what the regions of its side have in the eight cubes around it together: few bright
/// records decide what a region knows by itself.
///
/// sums: of each region `stride` sums, of counts[region] records.
void share_with_neighbors(const GuidingTables& t, const std::vector<std::uint32_t>& counts, std::size_t stride,
                          std::vector<double>& sums);

}  // namespace fathom
