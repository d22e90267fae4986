// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Part of the BVH with up to a few thousand items, written by one thread.
#include <vector>

#include "geometry/bvh/builder/binary.h"
#include "geometry/bvh/builder/child_order.h"

namespace fathom::bvh {

/// Lists the binary nodes that become the children of the wide node made from `node`. Choices must be known. Returns
/// their number.
int collect_children(const BinaryTree& tree, const BinaryNode& node, std::uint32_t* out);

/// Whether a node becomes a leaf rather than a wide node.
inline bool becomes_leaf(const BinaryNode& node)
{
    return node.leaf || node.choices[0] == 0;
}

/// Lists the item ids below a node that becomes a leaf, from left to right. Returns their number, at most 16.
int gather_ids(const BinaryTree& tree, const BinaryNode& node, std::uint32_t* out);

/// A part of the BVH. Its references are relative to its own arrays, except for triangles, which are stored in the
/// BVH's arrays.
struct Chunk {
    std::uint32_t from = 0;                ///< root of the chunk in the binary tree
    std::size_t first_triangle = 0;        ///< index of the first triangle in the BVH's arrays
    std::size_t triangles = 0;             ///< upper bound until the triangles are written, then their number
    std::size_t moved = 0;                 ///< distance by which its triangles were moved to the front
    std::size_t leaves = 0, children = 0;  ///< number of leaves, and total number of children of nodes
    int depth = 0;                         ///< number of levels from the root to the deepest leaf
    std::size_t first_node = 0,
                first_other = 0;  ///< indices of its first node and first other leaf in the BVH's arrays
    bool compact = false;         ///< whether leaves are indexed if that makes them much smaller
    Subtree root;
    std::vector<BvhNode> nodes;
    std::vector<std::uint32_t> others;
    /// Triangles of a compact chunk, of which there may be few: they are kept here until they are copied to the BVH's
    /// arrays.
    std::vector<float> triangles_apart;
    std::vector<BvhKey> keys_apart;

    /// Sets `triangles` to the upper bound.
    void count_triangles(const BinaryTree& tree);
    /// Writes the nodes and leaves of the chunk; triangles go to the BVH's arrays unless the chunk is compact.
    void write(const GeometryTables& tables, const BinaryTree& tree, BvhData& bvh);
};

}  // namespace fathom::bvh
