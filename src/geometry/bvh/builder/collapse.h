// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Collapse of a binary BVH to wide nodes of 16 children, and leaves.
#include "geometry/bvh/builder/binary.h"
#include "geometry/bvh/builder/child_order.h"

namespace fathom::bvh {

/// Expected cost of a ray that hits the root's box, in node visits, if the tree is collapsed optimally.
float expected_cost(const GeometryTables& tables, BinaryTree& tree);

/// Result of collapse().
struct Collapsed {
    std::uint32_t root;  ///< reference to the root, see BvhReference
    int depth;           ///< number of levels from the root to the deepest leaf
};

/// Adds the nodes and leaves of a tree to the BVH and frees the tree. next_triangle: index of the next free triangle,
/// updated. compact: as in Chunk.
Collapsed collapse(const GeometryTables& tables, BinaryTree& tree, BvhData& bvh, std::size_t& next_triangle,
                   bool compact);

}  // namespace fathom::bvh
