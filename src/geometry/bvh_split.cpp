#include "geometry/bvh_split.h"

namespace fathom::bvh {

void Bins::add(const Item* items, std::size_t n, const BinMap& map)
{
    for (std::size_t i = 0; i < n; ++i) {
        const V4i bin = map(center2(items[i]));
        const Box item(items[i]);
        for (int axis = 0; axis < 3; ++axis) {
            box[axis][bin[axis]].extend(item);
            ++count[axis][bin[axis]];
        }
    }
}

void Bins::merge(const Bins& other)
{
    for (int axis = 0; axis < 3; ++axis)
        for (int bin = 0; bin < max; ++bin) {
            box[axis][bin].extend(other.box[axis][bin]);
            count[axis][bin] += other.count[axis][bin];
        }
}

Split best_split(const Bins& bins, const BinMap& map)
{
    Split best;
    float best_cost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        if (!map.splits(axis)) continue;
        // cost[i]: of the bins above i.
        float cost[Bins::max];
        Box right;
        std::uint32_t count = 0;
        for (int i = map.last; i > 0; --i) {
            right.extend(bins.box[axis][i]);
            count += bins.count[axis][i];
            cost[i - 1] = count ? right.half_area() * float(count) : std::numeric_limits<float>::infinity();
        }
        Box left;
        count = 0;
        for (int i = 0; i < map.last; ++i) {
            left.extend(bins.box[axis][i]);
            count += bins.count[axis][i];
            if (!count) continue;
            const float sum = left.half_area() * float(count) + cost[i];
            if (sum < best_cost) {
                best_cost = sum;
                best.axis = axis;
                best.bin = i;
            }
        }
    }
    if (best.axis < 0) return best;
    for (int i = 0; i <= map.last; ++i) (i <= best.bin ? best.left : best.right).extend(bins.box[best.axis][i]);
    return best;
}

Split find_split(const Item* items, std::size_t n, const CenterBounds& centers, BinMap& map)
{
    map = BinMap(centers, n <= 4 ? 4 : n <= 16 ? 8 : Bins::max);
    Bins bins;
    bins.add(items, n, map);
    return best_split(bins, map);
}

std::size_t partition(Item* items, std::size_t n, const BinMap& map, const Split& split, CenterBounds& left,
                      CenterBounds& right)
{
    // Without branches: which side an item goes to can't be foreseen.
    constexpr float inf = std::numeric_limits<float>::infinity();
    const V4 none = {inf, inf, inf, inf};
    std::size_t to = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Item item = items[i];
        const V4 center = center2(item);
        const bool is_left = map(center)[split.axis] <= split.bin;
        items[i] = items[to];
        items[to] = item;
        to += is_left;
        const V4i l = V4i{} - std::int32_t(is_left);
        const V4 low = center, minus_high = -center;
        const V4 low_left = l ? low : none, low_right = l ? none : low;
        const V4 high_left = l ? minus_high : none, high_right = l ? none : minus_high;
        left.low = left.low < low_left ? left.low : low_left;
        left.minus_high = left.minus_high < high_left ? left.minus_high : high_left;
        right.low = right.low < low_right ? right.low : low_right;
        right.minus_high = right.minus_high < high_right ? right.minus_high : high_right;
    }
    return to;
}

}  // namespace fathom::bvh
