#include "geometry/bvh/build/split.h"

namespace fathom::bvh {

Bins::Bins(int bins) : used(bins)
{
    const V8 empty = Box().v;
    for (int bin = 0; bin < used; ++bin) {
        for (V8& b : box[bin]) b = empty;
        for (std::uint32_t& c : count[bin]) c = 0;
    }
}

namespace {

[[gnu::always_inline]] inline void add_to(Bins& bins, const Item& item, const BinMap& map)
{
    const V4i bin = map(center2(item));
    const Box box(item);
    for (int axis = 0; axis < 3; ++axis) {
        V8& b = bins.box[bin[axis]][axis];
        b = b < box.v ? b : box.v;
        ++bins.count[bin[axis]][axis];
    }
}

}  // namespace

void Bins::add(const Item* items, std::size_t n, const BinMap& map)
{
    if (n < 64) {
        for (std::size_t i = 0; i < n; ++i) add_to(*this, items[i], map);
        return;
    }
    // Neighbours often share a bin, and would wait for each other: they take turns with two sets.
    Bins odd(used);
    for (std::size_t i = 0; i + 1 < n; i += 2) {
        add_to(*this, items[i], map);
        add_to(odd, items[i + 1], map);
    }
    if (n & 1) add_to(*this, items[n - 1], map);
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
    // The three axes side by side.
    constexpr float inf = std::numeric_limits<float>::infinity();
    const V4 none = {inf, inf, inf, inf};
    struct Sweep {
        Box box[3];
        V4i count = {};
        /// Area times count by axis; none where there is nothing.
        V4 add(const Bins& from, int bin)
        {
            V4 x, y, z, n = {};
            x = y = z = n;
            V4i more;
            std::memcpy(&more, from.count[bin], sizeof more);
            count += more;
            for (int axis = 0; axis < 3; ++axis) {
                box[axis].extend(from.box[bin][axis]);
                x[axis] = -box[axis].v[4] - box[axis].v[0];
                y[axis] = -box[axis].v[5] - box[axis].v[1];
                z[axis] = -box[axis].v[6] - box[axis].v[2];
            }
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

std::size_t partition(Item* items, std::size_t n, const BinMap& map, const Split& split, CenterBounds& left,
                      CenterBounds& right)
{
    // Without branches: which side an item goes to can't be foreseen. Centres as (c, -c), like boxes.
    using V8i = std::int32_t __attribute__((vector_size(32)));
    const V8 none = Box().v;
    V8 bounds[2] = {none, none};
    const V4i last_left = V4i{} + split.bin;
    std::size_t to = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Item item = items[i];
        const V8 box = Box(item).v;
        const V8 center = box - __builtin_shufflevector(box, box, 4, 5, 6, 7, 0, 1, 2, 3);
        const V4i stays = map(__builtin_shufflevector(center, center, 0, 1, 2, 3)) <= last_left;
        const std::int32_t is_left = stays[split.axis];
        items[i] = items[to];
        items[to] = item;
        to -= std::ptrdiff_t(is_left);
        const V8i l = V8i{} + is_left;
        const V8 for_left = l ? center : none, for_right = l ? none : center;
        bounds[0] = bounds[0] < for_left ? bounds[0] : for_left;
        bounds[1] = bounds[1] < for_right ? bounds[1] : for_right;
    }
    std::memcpy(&left, &bounds[0], sizeof left);
    std::memcpy(&right, &bounds[1], sizeof right);
    return to;
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
