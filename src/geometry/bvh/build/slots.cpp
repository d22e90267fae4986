#include "geometry/bvh/build/slots.h"

#include <algorithm>

#include "geometry/bvh/build/cost.h"

namespace fathom::bvh {

namespace {

/// Slots by share of rays stopped, for the work it takes.
void order_by_blocking(const Subtree* children, int count, int* slots)
{
    for (int i = 0; i < count; ++i) {
        slots[i] = i;
        const auto gain = [&](int slot) { return children[slot].blocking / children[slot].cost; };
        for (int j = i; j > 0 && gain(slots[j]) < gain(slots[j - 1]); --j) std::swap(slots[j], slots[j - 1]);
    }
}

/// Slots by octant, from far to near: by the centre's place along the octant's diagonal.
void order_by_distance(BvhNode& node, int count)
{
    for (int octant = 0; octant < 4; ++octant) {
        // The opposite octant goes the other way round.
        float key[bvh_width];
        int slots[bvh_width];
        for (int i = 0; i < bvh_width; ++i) {
            slots[i] = i;
            key[i] = -std::numeric_limits<float>::infinity();
            if (i >= count) continue;
            key[i] = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const float c = node.bounds[axis][i] + node.bounds[3 + axis][i];
                key[i] += octant >> axis & 1 ? -c : c;
            }
        }
        for (int i = 1; i < bvh_width; ++i)
            for (int j = i; j > 0 && key[slots[j]] > key[slots[j - 1]]; --j) std::swap(slots[j], slots[j - 1]);
        std::uint64_t order = 0, opposite = 0;
        for (int i = 0; i < bvh_width; ++i) {
            order |= std::uint64_t(slots[i]) << 4 * i;
            opposite |= std::uint64_t(slots[bvh_width - 1 - i]) << 4 * i;
        }
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
