#pragma once
/// Which children of a node stop rays, found by trying.
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// Puts children into slots so that rays that ask for any hit first go to what stops most of `rays`, for the work it
/// takes: the surface area heuristic of finish_node() does not know that a room's walls, large as they are, stop
/// nothing between two places within. For trees in which nothing moves.
void order_by_occlusion(BvhData& tree, const RayArrays& rays);

}  // namespace fathom::bvh
