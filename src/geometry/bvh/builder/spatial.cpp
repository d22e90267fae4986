// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/spatial.h"

#include <algorithm>
#include <cmath>

namespace fathom::bvh {

namespace {

constexpr int planes = 16;
/// Sets with fewer items than this are not split spatially.
constexpr std::size_t min_items = 16;
/// Object splits whose sides overlap by less than this fraction of the scene's area are good enough.
constexpr float min_overlap = 1e-3f;

float overlap(const Box& a, const Box& b)
{
    Box both;
    both.v = a.v > b.v ? a.v : b.v;  // boxes are (low, -high), so the maximum is the intersection
    for (int axis = 0; axis < 3; ++axis)
        if (!(both.low(axis) <= both.high(axis))) return 0;
    return both.half_area();
}

bool is_empty(const Box& box)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!(box.low(axis) <= box.high(axis))) return true;
    return false;
}

bool is_empty(const Item& item)
{
    return is_empty(Box(item));
}

/// The cells between the candidate planes of each axis.
struct Cells {
    float low, size, inverse;
    Cells(float low, float high) : low(low), size((high - low) / planes), inverse(1 / size) {}
    float plane(int i) const { return low + size * float(i); }
    int of(float x) const { return std::clamp(int((x - low) * inverse), 0, planes - 1); }
};

Box around(const Vec3f& p)
{
    Box box;
    box.v = V8{p.x, p.y, p.z, 0, -p.x, -p.y, -p.z, 0};
    return box;
}

/// Extends the boxes of cells by the parts of a triangle within them. `item` is a piece of that triangle. The boxes are
/// approximate; cut() computes the actual ones.
void add_parts(const Item& item, const Vec3f* corners, int axis, const Cells& cells, int first, int last, Box* box)
{
    Box part[planes];
    for (int i = 0; i < 3; ++i) {
        V8 a = around(corners[i]).v, b = around(corners[(i + 1) % 3]).v;
        if (a[axis] > b[axis]) std::swap(a, b);
        const int begin = cells.of(a[axis]), end = cells.of(b[axis]);
        part[begin].extend(a);
        part[end].extend(b);
        const V8 step = (b - a) * (1 / (b[axis] - a[axis]));
        for (int k = std::max(begin, first - 1); k < std::min(end, last + 1); ++k) {
            const V8 on = a + step * (cells.plane(k + 1) - a[axis]);
            part[k].extend(on);
            part[k + 1].extend(on);
        }
    }
    const Box whole(item);
    for (int k = first; k <= last; ++k) {
        part[k].v =
            part[k].v > whole.v ? part[k].v : whole.v;  // boxes are (low, -high), so the maximum is the intersection
        if (!is_empty(part[k])) box[k].extend(part[k]);
    }
}

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
    // Boxes are rounded outward by more than float precision, which covers the errors of the double precision values.
    const auto margin = [](double x) { return float(std::abs(x)) * 0x1p-22f + 1e-37f; };
    for (int side = 0; side < 2; ++side) {
        Item& part = side == 0 ? left : right;
        part = whole;
        for (int k = 0; k < 3; ++k) {
            part.low[k] = std::max(part.low[k], float(low[side][k]) - margin(low[side][k]));
            part.minus_high[k] = std::max(part.minus_high[k], -(float(high[side][k]) + margin(high[side][k])));
        }
    }
    // The boxes of both sides end exactly on the plane, without rounding.
    left.minus_high[axis] = std::max(left.minus_high[axis], -at);
    right.low[axis] = std::max(right.low[axis], at);
}

SpatialSplitter::Plane SpatialSplitter::best_plane(const ItemSet& all) const
{
    Plane best;
    best.cost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const Cells cells(all.box.low(axis), all.box.high(axis));
        if (!(cells.size > 1e-30f)) continue;
        Box box[planes];
        std::size_t begin[planes] = {}, end[planes] = {};
        for (std::size_t k = 0; k < all.count; ++k) {
            const Item& item = all.items[k];
            int first = cells.of(item.low[axis]), last = cells.of(-item.minus_high[axis]);
            if (item.kind != Item::triangle) first = last = cells.of((item.low[axis] - item.minus_high[axis]) / 2);
            ++begin[first], ++end[last];
            if (first == last) {
                box[first].extend(item);
                continue;
            }
            Vec3f corners[3];
            vertices_of(tables_, item.id, corners);
            add_parts(item, corners, axis, cells, first, last, box);
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
            if (count == 0 || right_count[i] == 0 || count >= all.count || right_count[i] >= all.count) continue;
            const float cost = side.half_area() * float(count) + right_cost[i];
            if (!(cost < best.cost)) continue;
            best = {axis, cells.plane(i + 1), cost, count + right_count[i] - all.count};
        }
    }
    return best;
}

/// Splits items at a plane. Returns false if one side gets all of them, which coarse bins allow. The right pieces of
/// cut triangles follow the other items.
bool SpatialSplitter::divide(const ItemSet& all, const Plane& plane, ItemSet& left, ItemSet& right) const
{
    const auto add = [](ItemSet& side, const Item& item) {
        ++side.count;
        side.box.extend(item);
        side.centers.extend(center2(item));
    };
    std::size_t room = all.room;
    Item *to = all.items, *end = all.items + all.count;
    for (std::size_t i = 0; i < all.count; ++i) {
        const Item item = all.items[i];
        const float low = item.low[plane.axis], high = -item.minus_high[plane.axis];
        bool goes_left = high <= plane.at || (low < plane.at && low / 2 + high / 2 < plane.at);
        Item mine = item;
        if (low < plane.at && plane.at < high && item.kind == Item::triangle && room > 0) {
            Item l, r;
            cut(item, plane.axis, plane.at, l, r);
            goes_left = !is_empty(l);
            if (!is_empty(l) && !is_empty(r)) {
                mine = l;
                --room;
                *end++ = r;
                add(right, r);
            }
        }
        add(goes_left ? left : right, mine);
        all.items[i] = *to;
        *to = mine;
        to += goes_left;
    }
    left.items = all.items;
    right.items = to;
    left.room = room;  // gives all room to the left side; the caller divides it
    return left.count > 0 && right.count > 0;
}

void SpatialSplitter::split(const ItemSet& all, int depth, ItemSet& left, ItemSet& right) const
{
    BinMap map(all.centers, Bins::max);
    Split object;
    if (all.count > 2 && depth < halving_depth) object = find_split(all.items, all.count, all.centers, map);
    // Triangles stay whole if there is no room or no need for spatial splits.
    const bool crowded = object.axis < 0 || overlap(object.left, object.right) > min_overlap * root_area_;
    if (all.room > 0 && all.count >= min_items && depth < halving_depth && crowded) {
        const Plane plane = best_plane(all);
        const float object_cost = object.axis < 0 ? all.box.half_area() * float(all.count) : object.cost;
        if (plane.axis >= 0 && plane.cuts <= all.room && plane.cost < object_cost) {
            if (!divide(all, plane, left, right)) {
                ItemSet same = left.count > 0 ? left : right;
                same.room = left.room;
                left = right = {};
                split_at(same, {}, map, left, right);
                left.room = same.room;
            }
        }
    }
    if (left.count == 0) {
        split_at(all, object, map, left, right);
        left.room = all.room;
    }
    const std::size_t room = left.room, sum = left.count + right.count;
    left.room = room * left.count / sum;
    right.room = room - left.room;
    // The right side moves back by the left side's room; the order of its items does not matter.
    const std::size_t moved = std::min(left.room, right.count);
    std::copy_backward(right.items, right.items + moved, right.items + left.room + right.count);
    right.items += left.room;
}

}  // namespace fathom::bvh
