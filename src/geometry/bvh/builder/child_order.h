#pragma once
/// Which of a wide node's slots its children get, and in which order rays take them.
#include "geometry/bvh/builder/split.h"
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// A child of a wide node, or a root.
struct Subtree {
    std::uint32_t reference = 0;
    float blocking = 0;  ///< share of the rays through its box that something in it stops, roughly
    float cost = 0;      ///< of a ray through its box, in nodes visited
};

/// A node's parts: puts children into slots so that the last one stops rays soonest, for the work it takes; rays that
/// ask for any hit go there first. Returns what the node is to its own parent; its reference is left to be set.
Subtree finish_node(BvhNode& node, const Box* boxes, const Subtree* children, int count);

}  // namespace fathom::bvh
