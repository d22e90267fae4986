#pragma once
/// The binary tree over a list of items, which is then collapsed to wide nodes.
#include <algorithm>

#include "geometry/bvh/builder/cost.h"
#include "geometry/bvh/builder/items.h"

namespace fathom::bvh {

/// The first node is the root.
struct alignas(16) BinaryNode {
    static constexpr std::uint32_t none = ~std::uint32_t(0);

    float low[3];
    std::uint32_t left;  ///< child; of a leaf: its first item
    float minus_high[3];
    std::uint32_t right;
    Choices choices;  ///< once known
    std::uint32_t parent;
    /// Of items below, at most as many as fit; of inner nodes it is their height at first, see BinaryTree::counted.
    std::uint32_t count : 23;
    std::uint32_t kinds : 8;  ///< of items below
    std::uint32_t leaf : 1;   ///< of few items, side by side, which one leaf can hold

    static constexpr std::uint32_t max_count = (1u << 23) - 1;

    /// Steps down to the deepest leaf, while counts of inner nodes are that.
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

/// That of a node above these.
inline std::uint32_t height_above(const BinaryNode& left, const BinaryNode& right)
{
    return 1 + std::max(left.height(), right.height());
}

struct BinaryTree {
    LargeArray<BinaryNode> nodes;
    LargeArray<std::uint32_t> ids;  ///< of the items
    std::size_t peak_bytes = 0;     ///< while it was built, items and itself included
    bool counted = false;           ///< whether inner nodes' counts are those of items below; else their heights

    std::size_t bytes() const { return nodes.bytes() + ids.bytes(); }
};

/// Splits the items as the level says, by all threads; the same tree for any number of them. Items are freed.
/// cut  whether triangles may be cut in two, where that is better
BinaryTree split_items(const GeometryTables& tables, ItemList& list, TreeBuild level, bool cut);

}  // namespace fathom::bvh
