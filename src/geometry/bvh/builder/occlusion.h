// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Child order of nodes from measured occlusion.
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// Assigns children to slots so that occlusion rays first visit the children that block most of `rays` per cost. The
/// surface area heuristic of finish_node() does not know that the walls of a room, although large, block nothing
/// between two points inside. Only for BVHs without motion.
void order_by_occlusion(BvhData& tree, const RayArrays& rays);

}  // namespace fathom::bvh
