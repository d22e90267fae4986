// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/split.h"

#include <array>

namespace fathom::bvh {

Bins::Bins(int bins) : used(bins)
{
    const V8 empty = Box().v;
    for (int bin = 0; bin < used; ++bin) {
        for (V8& b : box[bin]) b = empty;
        for (std::uint32_t& c : count[bin]) c = 0;
    }
}

void Bins::add(const Item* items, std::size_t n, const BinMap& map)
{
    const auto add_to = [&](Bins& bins, const Item& item) {
        const Box item_box(item);
        const V4i bin = map(item_box.center2());
        for (int axis = 0; axis < 3; ++axis) {
            const std::uint32_t i = std::uint32_t(bin[axis]);
            V8& b = bins.box[i][axis];
            b = b < item_box.v ? b : item_box.v;
            ++bins.count[i][axis];
        }
    };
    if (n < 64) {
        for (std::size_t i = 0; i < n; ++i) add_to(*this, items[i]);
        return;
    }
    // Adjacent items often share a bin, and each update would wait for the last; alternating between two sets avoids
    // that.
    Bins odd(used);
    for (std::size_t i = 0; i + 1 < n; i += 2) {
        add_to(*this, items[i]);
        add_to(odd, items[i + 1]);
    }
    if (n & 1) add_to(*this, items[n - 1]);
    merge(odd);
}

void Bins::merge(const Bins& other)
{
    for (int bin = 0; bin < used; ++bin)
        for (int axis = 0; axis < 3; ++axis) {
            const V8& b = other.box[bin][axis];
            box[bin][axis] = box[bin][axis] < b ? box[bin][axis] : b;
            count[bin][axis] += other.count[bin][axis];
        }
}

Split best_split(const Bins& bins, const BinMap& map)
{
    // All three axes are swept at once.
    constexpr float inf = std::numeric_limits<float>::infinity();
    const V4 none = {inf, inf, inf, inf};
    struct Sweep {
        Box box[3];
        V4i count = {};
        /// Surface area times number of items, for each axis; NaN for empty sides.
        V4 add(const Bins& from, int bin)
        {
            V4i more;
            std::memcpy(&more, from.count[bin], sizeof more);
            count += more;
            V4 size[3];
            for (int axis = 0; axis < 3; ++axis) {
                box[axis].extend(from.box[bin][axis]);
                size[axis] = box[axis].minus_size();
            }
            const V4 xy_low = __builtin_shufflevector(size[0], size[1], 0, 4, 1, 5);
            const V4 x = __builtin_shufflevector(xy_low, size[2], 0, 1, 4, 7);
            const V4 y = __builtin_shufflevector(xy_low, size[2], 2, 3, 5, 7);
            const V4 xy_high = __builtin_shufflevector(size[0], size[1], 2, 6, 3, 7);
            const V4 z = __builtin_shufflevector(xy_high, size[2], 0, 1, 6, 7);
            return (x * y + (x + y) * z) * __builtin_convertvector(count, V4);
        }
    };
    V4 right_cost[Bins::max];
    V4 best_cost = none;
    V4i best_bin = {};
    Sweep right, left;
    for (int i = map.last; i > 0; --i) {
        const V4 cost = right.add(bins, i);
        right_cost[i - 1] = right.count > 0 ? cost : none;
    }
    for (int i = 0; i < map.last; ++i) {
        const V4 sum = left.add(bins, i) + right_cost[i];
        const V4i better = V4i(sum < best_cost) & V4i(left.count > 0);
        best_cost = better ? sum : best_cost;
        best_bin = better ? V4i{} + i : best_bin;
    }
    Split best;
    float least = inf;
    for (int axis = 0; axis < 3; ++axis)
        if (map.splits(axis) && best_cost[axis] < least) {
            least = best_cost[axis];
            best.axis = axis;
            best.bin = best_bin[axis];
            best.cost = least;
        }
    if (best.axis < 0) return best;
    for (int i = 0; i <= map.last; ++i) (i <= best.bin ? best.left : best.right).extend(bins.box[i][best.axis]);
    return best;
}

Split find_split(const Item* items, std::size_t n, const CenterBounds& centers, BinMap& map)
{
    map = BinMap(centers, n <= 8 ? 4 : n <= 32 ? 8 : Bins::max);
    Bins bins(map.last + 1);
    bins.add(items, n, map);
    return best_split(bins, map);
}

namespace {

/// Branch-free, since the side of an item is unpredictable. Bounds of centers are kept as (c, -c), like boxes.
template <int axis>
std::size_t partition_along(Item* items, std::size_t n, const BinMap& map, int last_left, CenterBounds& left,
                            CenterBounds& right)
{
    using V8i = std::int32_t __attribute__((vector_size(32)));
    const V8 none = Box().v;
    V8 left_bounds = none, right_bounds = none;
    const V4i last = V4i{} + last_left;
    std::size_t to = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Item item = items[i];
        const V8 box = Box(item).v;
        const V8 center = box - __builtin_shufflevector(box, box, 4, 5, 6, 7, 0, 1, 2, 3);
        const V4i stays = map(__builtin_shufflevector(center, center, 0, 1, 2, 3)) <= last;
        const V8i l = __builtin_shufflevector(stays, stays, axis, axis, axis, axis, axis, axis, axis, axis);
        items[i] = items[to];
        items[to] = item;
        to -= std::ptrdiff_t(stays[axis]);
        const V8 for_left = l ? center : none, for_right = l ? none : center;
        left_bounds = left_bounds < for_left ? left_bounds : for_left;
        right_bounds = right_bounds < for_right ? right_bounds : for_right;
    }
    const auto as_bounds = [](const V8& v, CenterBounds& out) {
        out.low = __builtin_shufflevector(v, v, 0, 1, 2, 3);
        out.minus_high = __builtin_shufflevector(v, v, 4, 5, 6, 7);
    };
    as_bounds(left_bounds, left);
    as_bounds(right_bounds, right);
    return to;
}

}  // namespace

std::size_t partition(Item* items, std::size_t n, const BinMap& map, const Split& split, CenterBounds& left,
                      CenterBounds& right)
{
    constexpr auto along = std::array{partition_along<0>, partition_along<1>, partition_along<2>};
    return along[std::size_t(split.axis)](items, n, map, split.bin, left, right);
}

void split_at(const ItemSet& all, const Split& split, const BinMap& map, ItemSet& left, ItemSet& right)
{
    if (split.axis >= 0) {
        left.count = partition(all.items, all.count, map, split, left.centers, right.centers);
        left.box = split.left;
        right.box = split.right;
    } else {
        left.count = all.count / 2;
        for (std::size_t i = 0; i < all.count; ++i) {
            ItemSet& side = i < left.count ? left : right;
            side.box.extend(all.items[i]);
            side.centers.extend(center2(all.items[i]));
        }
    }
    left.items = all.items;
    right.items = all.items + left.count;
    right.count = all.count - left.count;
}

void split_objects(const ItemSet& all, int depth, ItemSet& left, ItemSet& right)
{
    BinMap map(all.centers, Bins::max);
    Split split;
    if (all.count > 2 && depth < halving_depth) split = find_split(all.items, all.count, all.centers, map);
    split_at(all, split, map, left, right);
}

}  // namespace fathom::bvh
