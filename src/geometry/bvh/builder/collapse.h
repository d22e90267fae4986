#pragma once
/// From a binary tree to nodes of 16 children and leaves.
#include "geometry/bvh/builder/binary.h"
#include "geometry/bvh/builder/child_order.h"

namespace fathom::bvh {

/// Of a ray that meets the root's box, in nodes visited, if the tree is collapsed as well as it can be.
float expected_cost(const GeometryTables& tables, BinaryTree& tree);

struct Collapsed {
    std::uint32_t root;  ///< a reference
    int depth;           ///< nodes from the root down to the deepest leaf
};

/// Adds the nodes and leaves of a tree, which is then freed.
/// next_triangle  where its triangles go, and then the next tree's
/// compact        as in Chunk
Collapsed collapse(const GeometryTables& tables, BinaryTree& tree, BvhData& bvh, std::size_t& next_triangle,
                   bool compact);

}  // namespace fathom::bvh
