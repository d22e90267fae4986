// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Binary BVH over a list of items, which is collapsed to wide nodes afterwards.
#include <algorithm>

#include "geometry/bvh/builder/cost.h"
#include "geometry/bvh/builder/items.h"

namespace fathom::bvh {

/// Node of a binary BVH; node 0 is the root.
struct alignas(16) BinaryNode {
    static constexpr std::uint32_t none = ~std::uint32_t(0);

    float low[3];
    std::uint32_t left;  ///< left child; for a leaf, the index of its first item
    float minus_high[3];
    std::uint32_t right;
    Choices choices;  ///< how the subtree collapses to wide nodes, once it is known
    std::uint32_t parent;
    /// Number of items below, clamped to max_count; for inner nodes the height until BinaryTree::counted is set.
    std::uint32_t count : 23;
    std::uint32_t kinds : 8;  ///< union of the Item::Kind of all items below
    std::uint32_t leaf : 1;   ///< set if the items are few, contiguous and of kinds that one leaf can hold

    static constexpr std::uint32_t max_count = (1u << 23) - 1;

    /// Number of levels below the node; valid while inner nodes store heights.
    std::uint32_t height() const { return leaf ? 0 : std::uint32_t(count); }

    Box box() const { return Box(static_cast<const void*>(this)); }
    void set_box(const Box& b)
    {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = b.v[axis];
            minus_high[axis] = b.v[4 + axis];
        }
    }
};
static_assert(sizeof(BinaryNode) == 48);

/// Height of a node with these children.
inline std::uint32_t height_above(const BinaryNode& left, const BinaryNode& right)
{
    return 1 + std::max(left.height(), right.height());
}

/// A binary BVH and the memory that building it took.
struct BinaryTree {
    LargeArray<BinaryNode> nodes;
    LargeArray<std::uint32_t> ids;  ///< ids of the items, in the order of leaves
    std::size_t peak_bytes = 0;     ///< peak memory of construction, items and result included
    bool counted = false;           ///< whether inner nodes store item counts instead of heights

    std::size_t bytes() const { return nodes.bytes() + ids.bytes(); }
};

/// Builds the tree over the items at the given quality level, with all threads; the result does not depend on their
/// number. Frees the items. cut: whether spatial splits may cut triangles.
BinaryTree split_items(const GeometryTables& tables, ItemList& list, BvhQuality level, bool cut);

}  // namespace fathom::bvh
