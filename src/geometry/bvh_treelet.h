#pragma once
/// The lower part of the tree: up to some ten thousand items, split down to a few by one thread, then collapsed
/// to nodes of 16 children by dynamic programming.
#include <array>
#include <vector>

#include "geometry/bvh_data.h"
#include "geometry/bvh_spatial.h"

namespace fathom::bvh {

/// Expected work of a ray below a binary node, where it may stand for up to 1, 2, ... 16 children of a wide node:
/// Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.3.
struct alignas(64) Costs {
    std::array<float, bvh_width> c;
};

/// How to reach these costs: [j - 1] for j children: how many of them the left side gets, or 0 if one is best. [0]: how
/// the 16 children of a wide node made here divide, or 0 if a leaf is best.
using Choices = std::array<std::uint8_t, bvh_width>;

/// Joins two sides. half_area is of the node above them, leaf_cost infinite where it can't be a leaf.
Costs join(const Costs& left, const Costs& right, float half_area, float leaf_cost, Choices& choices);

/// Of one leaf, by a ray that meets it; infinite where there can be no such leaf.
float leaf_cost(std::uint32_t kinds, std::size_t count);

/// A child of a wide node, or a root.
struct Subtree {
    std::uint32_t reference = 0;
    float blocking = 0;  ///< share of the rays through its box that something in it stops, roughly
    float cost = 0;      ///< of a ray through its box, in nodes visited
};

/// A range of items at the bottom of the upper tree, and what was built of it. References are relative to the arrays
/// here, but those of triangles, which lie in the tree's.
struct Treelet {
    Item* items = nullptr;
    std::size_t count = 0, triangles = 0;  ///< triangles: how many of the items are
    std::size_t first_triangle = 0;        ///< where in the tree's arrays they go
    std::size_t moved = 0;                 ///< by how much they were moved towards the front afterwards
    Box box;
    CenterBounds centers;
    int depth = 0;
    /// Of the items, by which they are sorted, and then split; null: they are split by the surface area heuristic.
    const std::uint32_t* codes = nullptr;
    /// If not empty: items that may be cut, instead of the above.
    ItemSide side;
    float root_area = 0;
    bool compact = false;  ///< leaves of triangles hold each vertex once, where that is much smaller
    /// So many items stay together where one leaf can hold them.
    std::size_t together = 1;

    Subtree root;
    float cost = 0;
    std::vector<BvhNode> nodes;
    std::vector<std::uint32_t> others;
    /// Of a compact one, of which few triangles may be left: what else is written into the tree's arrays.
    std::vector<float> triangles_apart;
    std::vector<BvhKey> keys_apart;
    std::size_t leaves = 0;

    /// How many triangles it may have at most.
    std::size_t most_triangles() const { return triangles + side.budget; }
    /// Writes the triangles' vertices and keys into bvh, if not compact; `triangles` is then how many there are. Where
    /// there are codes, box is found here.
    void build(const SceneTables& tables, BvhData& bvh);
};

/// A node's parts: puts children into slots so that the last one stops rays soonest, for the work it takes; rays that
/// ask for any hit go there first. Returns what the node is to its own parent; its reference is left to be set.
Subtree finish_node(BvhNode& node, const Box* boxes, const Subtree* children, int count);

/// Splits where find_split finds nothing, or the tree gets too deep: in halves.
std::size_t halve(const Item* items, std::size_t n, Split& split, CenterBounds& left, CenterBounds& right);

}  // namespace fathom::bvh
