// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Assignment of children to the slots of a wide node, and the order in which rays visit them.
#include "geometry/bvh/builder/split.h"
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// A child of a wide node, or a root, with estimates for rays through its box.
struct Subtree {
    std::uint32_t reference = 0;
    float blocking = 0;  ///< estimated fraction of rays through its box that hit something in it
    float cost = 0;      ///< expected cost of a ray through its box, in node visits
};

/// Fills in a wide node. The last slot gets the child that blocks most rays per cost; occlusion rays visit it first.
/// Returns the node as a child of its own parent; the caller sets its reference.
Subtree finish_node(BvhNode& node, const Box* boxes, const Subtree* children, int count);

}  // namespace fathom::bvh
