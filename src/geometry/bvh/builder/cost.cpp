// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/cost.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "geometry/bvh/builder/split.h"

namespace fathom::bvh {

namespace {

using V16 = float __attribute__((vector_size(64)));
using V16i = std::int32_t __attribute__((vector_size(64)));

// Costs in units of a node visit, measured on interiors, terrain and foliage (bench/rays.cpp).
constexpr float triangle_leaf_cost = 0.7f, triangle_cost = 0.015f, other_leaf_cost = 0.7f, other_cost = 0.05f,
                instance_cost = 4.f, moving_leaf_cost = 0.4f, moving_triangle_cost = 0.06f, curve_leaf_cost = 1.5f,
                curve_cost = 0.1f, point_leaf_cost = 0.5f, point_cost = 0.05f;

}  // namespace

float leaf_cost(std::uint32_t kinds, std::size_t count)
{
    constexpr float none = std::numeric_limits<float>::infinity();
    if (count > bvh_width) return none;
    switch (kinds) {
        case Item::triangle:
            return triangle_leaf_cost + triangle_cost * float(count);
        case Item::sphere:
        case Item::disk:
            return other_leaf_cost + other_cost * float(count);
        case Item::instance:
            return count == 1 ? instance_cost : none;
        case Item::moving_triangle:
            return moving_leaf_cost + moving_triangle_cost * float(count);
        case Item::curve:
        case Item::ribbon:
            return curve_leaf_cost + curve_cost * float(count);
        case Item::point:
            return point_leaf_cost + point_cost * float(count);
        default:
            return none;
    }
}

Costs join(const Costs& left, const Costs& right, float half_area, float leaf, Choices& choices)
{
    // padded[15 + j] is the cost of the right side as j + 1 children; infinite for fewer than 1.
    alignas(64) float padded[2 * bvh_width];
    for (int i = 0; i < bvh_width; ++i) padded[i] = std::numeric_limits<float>::infinity();
    std::memcpy(padded + bvh_width, right.c.data(), sizeof right.c);
    // Lane i stands for i + 1 children, of which the left side gets k.
    V16 best;
    std::memcpy(&best, padded, sizeof best);
    V16i best_k = {};
    for (int k = 1; k < std::min(bvh_width, left.most + 1); ++k) {
        V16 r;
        std::memcpy(&r, padded + bvh_width - k, sizeof r);
        const V16 sum = left.c[std::size_t(k - 1)] + r;
        const V16i less = sum < best;
        best = less ? sum : best;
        best_k = less ? V16i{} + k : best_k;
    }
    const float node = half_area * node_cost + best[bvh_width - 1];
    const float one = std::min(node, half_area * leaf);
    const V16i split = best < V16{} + one;
    best = split ? best : V16{} + one;
    const V16i stored = split ? best_k : V16i{};
    choices.bits = half_area * leaf <= node ? 0 : std::uint64_t(best_k[bvh_width - 1]);
    for (int i = 1; i < bvh_width; ++i) choices.bits |= std::uint64_t(stored[i]) << 4 * i;
    Costs costs;
    std::memcpy(costs.c.data(), &best, sizeof best);
    costs.c[0] = one;
    costs.most = std::min(bvh_width, left.most + right.most);
    return costs;
}

}  // namespace fathom::bvh
