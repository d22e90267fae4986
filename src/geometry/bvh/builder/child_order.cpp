// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/child_order.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "geometry/bvh/builder/cost.h"

namespace fathom::bvh {

namespace {

using V16 = float __attribute__((vector_size(64)));
using V16i = std::int32_t __attribute__((vector_size(64)));

/// The sort key of unused lanes ranks after all others.
const V16 unused = V16(V16i{} - 1);
constexpr V16i lane_numbers = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

/// Rank of each lane by descending key; lanes with equal keys keep their order. Keys are compared as integers, which
/// gives NaN a defined rank, too.
void find_ranks(const V16& keys, std::int32_t* ranks)
{
    const V16i bits = V16i(keys), ordered = bits ^ (bits >> 31 & 0x7fffffff);
    V16i before = {};
    for (int j = 0; j < bvh_width; ++j)
        before -= (V16i{} + ordered[j] > ordered) | ((V16i{} + ordered[j] == ordered) & (lane_numbers > j));
    std::memcpy(ranks, &before, sizeof before);
}

/// Assigns slots by ascending ratio of blocked rays to traversal cost.
void order_by_blocking(const Subtree* children, int count, int* slots)
{
    V16 loss = unused;
    for (int i = 0; i < count; ++i) loss[i] = -children[i].blocking / children[i].cost;
    std::int32_t ranks[bvh_width];
    find_ranks(loss, ranks);
    for (int i = 0; i < count; ++i) slots[ranks[i]] = i;
}

/// Reverses the order of the sixteen 4-bit digits.
std::uint64_t reversed(std::uint64_t digits)
{
    digits = __builtin_bswap64(digits);
    return (digits & 0x0f0f0f0f0f0f0f0fu) << 4 | (digits >> 4 & 0x0f0f0f0f0f0f0f0fu);
}

/// Stores for each octant of ray directions the order of slots from far to near, by box center along the octant's
/// diagonal.
void order_by_distance(BvhNode& node, int count)
{
    V16 center[3];
    for (int axis = 0; axis < 3; ++axis) {
        V16 low, high;
        std::memcpy(&low, node.bounds[axis], sizeof low);
        std::memcpy(&high, node.bounds[3 + axis], sizeof high);
        center[axis] = low + high;
    }
    const V16i used = lane_numbers < count;
    for (int octant = 0; octant < 4; ++octant) {
        // Four octants suffice: the opposite octant uses the reversed order.
        const V16 along = (octant & 1 ? -center[0] : center[0]) + (octant & 2 ? -center[1] : center[1]) + center[2];
        std::int32_t ranks[bvh_width];
        find_ranks(used ? along : unused, ranks);
        std::uint64_t order = 0;
        for (int i = 0; i < bvh_width; ++i) order |= std::uint64_t(i) << 4 * ranks[i];
        const std::uint64_t opposite = reversed(order);
        for (int word = 0; word < 2; ++word) {
            node.order[octant][word] = std::uint32_t(order >> 32 * word);
            node.order[octant ^ 7][word] = std::uint32_t(opposite >> 32 * word);
        }
    }
}

}  // namespace

Subtree finish_node(BvhNode& node, const Box* boxes, const Subtree* children, int count)
{
    int from[bvh_width];
    order_by_blocking(children, count, from);
    Box all;
    for (int i = 0; i < count; ++i) all.extend(boxes[i]);
    const float half_area = std::max(all.half_area(), std::numeric_limits<float>::min());
    float passing = 1, cost = node_cost;
    constexpr float inf = std::numeric_limits<float>::infinity();
    for (int i = 0; i < bvh_width; ++i) {
        const bool used = i < count;
        node.child[i] = used ? children[from[i]].reference : 0;
        for (int axis = 0; axis < 3; ++axis) {
            node.bounds[axis][i] = used ? boxes[from[i]].low(axis) : inf;
            node.bounds[3 + axis][i] = used ? boxes[from[i]].high(axis) : -inf;
        }
        if (!used) continue;
        const float share = boxes[from[i]].half_area() / half_area;
        passing *= 1 - share * children[from[i]].blocking;
        cost += share * children[from[i]].cost;
    }
    order_by_distance(node, count);
    return {0, 1 - passing, cost};
}

}  // namespace fathom::bvh
