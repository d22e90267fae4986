#pragma once
/// A part of the tree of some ten thousand items that one thread writes.
#include <vector>

#include "geometry/bvh/builder/binary.h"
#include "geometry/bvh/builder/child_order.h"

namespace fathom::bvh {

/// The binary nodes that are the children of the wide node made of a node; how many. Choices are known.
int collect_children(const BinaryTree& tree, const BinaryNode& node, std::uint32_t* out);

/// Whether a node becomes a leaf rather than a wide node.
inline bool becomes_leaf(const BinaryNode& node)
{
    return node.leaf || node.choices[0] == 0;
}

/// The ids of the items below, from left to right, of a node that becomes a leaf. How many; room for 16.
int gather_ids(const BinaryTree& tree, const BinaryNode& node, std::uint32_t* out);

/// References are relative to the arrays here, but those of triangles, which lie in the tree's.
struct Chunk {
    std::uint32_t from = 0;                       ///< the binary node that is its root
    std::size_t first_triangle = 0;               ///< where in the tree's arrays they go
    std::size_t triangles = 0;                    ///< at most; when it is written: how many there are
    std::size_t moved = 0;                        ///< by how much they were moved towards the front afterwards
    std::size_t leaves = 0, children = 0;         ///< of leaves how many, and of all nodes' children
    int depth = 0;                                ///< nodes from its root down to the deepest leaf
    std::size_t first_node = 0, first_other = 0;  ///< where they go in the tree's arrays
    bool compact = false;  ///< leaves of triangles hold each vertex once, where that is much smaller
    Subtree root;
    std::vector<BvhNode> nodes;
    std::vector<std::uint32_t> others;
    /// Of a compact one, in which few triangles may be left: what else is written into the tree's arrays.
    std::vector<float> triangles_apart;
    std::vector<BvhKey> keys_apart;

    /// Finds `triangles`.
    void count_triangles(const BinaryTree& tree);
    void write(const GeometryTables& tables, const BinaryTree& tree, BvhData& bvh);
};

}  // namespace fathom::bvh
