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

/// Cost of a leaf of primitives of one kind, and what each primitive adds, in units of a node visit.
struct LeafCost {
    std::uint32_t kind;
    float leaf, primitive;
};
// The costs were measured on interiors, terrain and foliage (bench/rays.cpp).
constexpr LeafCost leaf_costs[] = {{Item::triangle, 0.7f, 0.015f}, {Item::sphere, 0.7f, 0.05f},
                                   {Item::disk, 0.7f, 0.05f},      {Item::instance, 4.f, 0.f},
                                   {Item::curve, 1.5f, 0.1f},      {Item::ribbon, 1.5f, 0.1f},
                                   {Item::point, 0.5f, 0.05f},     {Item::moving_triangle, 0.4f, 0.06f}};

}  // namespace

float leaf_cost(std::uint32_t kinds, std::size_t count)
{
    constexpr float none = std::numeric_limits<float>::infinity();
    if (count > std::size_t(kinds == Item::instance ? 1 : bvh_width)) return none;
    for (const LeafCost& cost : leaf_costs)
        if (cost.kind == kinds) return cost.leaf + cost.primitive * float(count);
    return none;
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
