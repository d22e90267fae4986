// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Optimal collapse of a binary BVH to nodes of 16 children, by dynamic programming over the expected cost of a ray.
#include <array>
#include <cstddef>
#include <cstdint>

#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// Cost of visiting a node: the unit of all costs.
inline constexpr float node_cost = 1.f;

/// Expected cost of a ray below a binary node that may become up to 1, 2, ... 16 children of a wide node: Ylitie,
/// Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.3.
struct alignas(64) Costs {
    std::array<float, bvh_width> c;
    int most = 1;  ///< largest useful number of children, up to 16: more children are not cheaper
};

/// The decisions that lead to these costs, 4 bits each. [j - 1]: the number of children that the left side gets if
/// there are j, or 0 if one child is best. [0]: how the 16 children of a wide node made here are divided, or 0 if a
/// leaf is best.
struct Choices {
    std::uint64_t bits = 0;
    int operator[](int i) const { return int(bits >> 4 * i & 15); }
};

/// Combines the costs of two children. half_area: half of the surface area of the node's box; leaf_cost: infinite if
/// the node can't be a leaf.
Costs join(const Costs& left, const Costs& right, float half_area, float leaf_cost, Choices& choices);

/// Cost of one leaf for a ray that hits its box; infinite if no such leaf can exist.
float leaf_cost(std::uint32_t kinds, std::size_t count);

}  // namespace fathom::bvh
