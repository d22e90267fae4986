#include "geometry/bvh_spatial.h"

#include <algorithm>
#include <cmath>

#include "geometry/bvh_treelet.h"

namespace fathom::bvh {

namespace {

constexpr int planes = 16;
constexpr int halving_depth = 50;
/// Fewer are not worth looking for a plane between.
constexpr std::size_t least_items = 16;
/// Sides of an object split that share less than this part of the scene's box are good enough.
constexpr float least_overlap = 1e-5f;

float overlap(const Box& a, const Box& b)
{
    Box both;
    both.v = a.v > b.v ? a.v : b.v;  // (low, -high): the larger is the inner
    for (int axis = 0; axis < 3; ++axis)
        if (!(both.low(axis) <= both.high(axis))) return 0;
    return both.half_area();
}

bool is_empty(const Item& item)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!(item.low[axis] <= -item.minus_high[axis])) return true;
    return false;
}

/// Where the planes between bins are; a little irregular from rounding, but the same for all who ask.
struct Cells {
    float low, size;
    float plane(int i) const { return low + size * float(i); }
    int of(float x) const { return std::clamp(int((x - low) / size), 0, planes - 1); }
};

}  // namespace

void SpatialSplitter::cut(const Item& whole, int axis, float at, Item& left, Item& right) const
{
    Vec3f corners[3];
    vertices_of(tables_, whole.id, corners);
    double low[2][3], high[2][3];
    std::fill_n(&low[0][0], 6, 1e300), std::fill_n(&high[0][0], 6, -1e300);
    const auto extend = [&](int side, const double* p) {
        for (int k = 0; k < 3; ++k)
            low[side][k] = std::min(low[side][k], p[k]), high[side][k] = std::max(high[side][k], p[k]);
    };
    for (int i = 0; i < 3; ++i) {
        const Vec3f &a = corners[i], &b = corners[(i + 1) % 3];
        const double p[] = {a.x, a.y, a.z}, q[] = {b.x, b.y, b.z};
        const double p_beyond = p[axis] - double(at), q_beyond = q[axis] - double(at);
        if (p_beyond <= 0) extend(0, p);
        if (p_beyond >= 0) extend(1, p);
        if (!(p_beyond < 0 && q_beyond > 0) && !(p_beyond > 0 && q_beyond < 0)) continue;
        double on[3];
        for (int k = 0; k < 3; ++k) on[k] = p[k] + (q[k] - p[k]) * (p_beyond / (p_beyond - q_beyond));
        on[axis] = at;
        extend(0, on), extend(1, on);
    }
    // Rounded outwards by more than a float's precision; what was computed in double is nearer to the truth than that.
    const auto margin = [](double x) { return float(std::abs(x)) * 0x1p-22f + 1e-37f; };
    for (int side = 0; side < 2; ++side) {
        Item& part = side == 0 ? left : right;
        part = whole;
        for (int k = 0; k < 3; ++k) {
            part.low[k] = std::max(part.low[k], float(low[side][k]) - margin(low[side][k]));
            part.minus_high[k] = std::max(part.minus_high[k], -(float(high[side][k]) + margin(high[side][k])));
        }
    }
    // Corners lie on the plane as they are.
    left.minus_high[axis] = std::max(left.minus_high[axis], -at);
    right.low[axis] = std::max(right.low[axis], at);
}

SpatialSplitter::Plane SpatialSplitter::best_plane(const ItemSide& all) const
{
    Plane best;
    best.cost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const Cells cells{all.box.low(axis), (all.box.high(axis) - all.box.low(axis)) / planes};
        if (!(cells.size > 1e-30f)) continue;
        Box box[planes];
        std::size_t begin[planes] = {}, end[planes] = {};
        for (const Item& item : all.items) {
            int first = cells.of(item.low[axis]), last = cells.of(-item.minus_high[axis]);
            if (item.kind != Item::triangle) first = last = cells.of((item.low[axis] - item.minus_high[axis]) / 2);
            ++begin[first], ++end[last];
            Item rest = item;
            for (int i = first; i < last; ++i) {
                Item left, right;
                cut(rest, axis, cells.plane(i + 1), left, right);
                if (!is_empty(left)) box[i].extend(left);
                rest = right;
                if (is_empty(rest)) break;
            }
            if (!is_empty(rest)) box[last].extend(rest);
        }
        float right_cost[planes];
        std::size_t right_count[planes], count = 0;
        Box side;
        for (int i = planes - 1; i > 0; --i) {
            side.extend(box[i]);
            right_count[i - 1] = count += end[i];
            right_cost[i - 1] = count ? side.half_area() * float(count) : 0;
        }
        side = Box();
        count = 0;
        for (int i = 0; i + 1 < planes; ++i) {
            side.extend(box[i]);
            count += begin[i];
            if (count == 0 || right_count[i] == 0) continue;
            const float cost = side.half_area() * float(count) + right_cost[i];
            if (!(cost < best.cost)) continue;
            best = {axis, cells.plane(i + 1), cost, count + right_count[i] - all.items.size()};
        }
    }
    return best;
}

void SpatialSplitter::divide(const ItemSide& all, const Plane& plane, ItemSide& left, ItemSide& right) const
{
    for (const Item& item : all.items) {
        const float low = item.low[plane.axis], high = -item.minus_high[plane.axis];
        if (high <= plane.at) {
            left.add(item);
        } else if (low >= plane.at) {
            right.add(item);
        } else if (item.kind != Item::triangle) {
            (low / 2 + high / 2 < plane.at ? left : right).add(item);
        } else {
            Item l, r;
            cut(item, plane.axis, plane.at, l, r);
            if (!is_empty(l)) left.add(l);
            if (!is_empty(r)) right.add(r);
        }
    }
}

void SpatialSplitter::split(ItemSide& all, int depth, ItemSide& left, ItemSide& right) const
{
    const std::size_t n = all.items.size();
    BinMap map(all.centers, Bins::max);
    Split object;
    if (n > 2 && depth < halving_depth) object = find_split(all.items.data(), n, all.centers, map);
    // Without a budget, or without need, triangles stay whole.
    const bool crowded = object.axis < 0 || overlap(object.left, object.right) > least_overlap * root_area_;
    if (all.budget > 0 && n >= least_items && depth < halving_depth && crowded) {
        const Plane plane = best_plane(all);
        const float object_cost = object.axis < 0 ? all.box.half_area() * float(n) : object.cost;
        if (plane.axis >= 0 && plane.cuts <= all.budget && plane.cost < object_cost) {
            divide(all, plane, left, right);
            // One side may have got all, and bins are coarse: then objects are split after all.
            const std::size_t sum = left.items.size() + right.items.size();
            if (left.items.size() < n && right.items.size() < n && !left.items.empty() && !right.items.empty() &&
                sum - n <= all.budget) {
                const std::size_t budget = all.budget - (sum - n);
                left.budget = budget * left.items.size() / sum;
                right.budget = budget - left.budget;
                all = {};
                return;
            }
            left = right = {};
        }
    }
    std::size_t middle = 0;
    if (object.axis >= 0)
        middle = partition(all.items.data(), n, map, object, left.centers, right.centers);
    else
        middle = halve(all.items.data(), n, object, left.centers, right.centers);
    left.box = object.left;
    right.box = object.right;
    left.items.assign(all.items.begin(), all.items.begin() + std::ptrdiff_t(middle));
    right.items.assign(all.items.begin() + std::ptrdiff_t(middle), all.items.end());
    left.budget = all.budget * middle / n;
    right.budget = all.budget - left.budget;
    all = {};
}

}  // namespace fathom::bvh
