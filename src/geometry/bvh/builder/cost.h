#pragma once
/// How a binary tree is best collapsed to nodes of 16 children, by dynamic programming over the expected work of a ray.
#include <array>
#include <cstddef>
#include <cstdint>

#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// In units of one node visited.
inline constexpr float node_cost = 1.f;

/// Expected work of a ray below a binary node, where it may stand for up to 1, 2, ... 16 children of a wide node:
/// Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.3.
struct alignas(64) Costs {
    std::array<float, bvh_width> c;
    int most = 1;  ///< so many children at most, if they are less than 16: more are no cheaper
};

/// How to reach these costs, 4 bits each: [j - 1] for j children: how many of them the left side gets, or 0 if one is
/// best. [0]: how the 16 children of a wide node made here divide, or 0 if a leaf is best.
struct Choices {
    std::uint64_t bits = 0;
    int operator[](int i) const { return int(bits >> 4 * i & 15); }
};

/// Joins two sides. half_area is of the node above them, leaf_cost infinite where it can't be a leaf.
Costs join(const Costs& left, const Costs& right, float half_area, float leaf_cost, Choices& choices);

/// Of one leaf, by a ray that meets it; infinite where there can be no such leaf.
float leaf_cost(std::uint32_t kinds, std::size_t count);

}  // namespace fathom::bvh
