// SPDX-License-Identifier: Apache-2.0
#include "lights/tree/build_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <tuple>

#include "lights/compile/kind.h"

namespace fathom {

namespace {

using std::numbers::pi;
constexpr double infinite = std::numeric_limits<double>::infinity();
/// Margins of bounds on positions, against rounding of the records and of the kernel's arithmetic.
constexpr double radius_slack = 1e-5, position_slack = 0x1p-21, min_radius = 1e-6;

std::array<double, 3> axes(const Vec3d& v)
{
    return {v.x, v.y, v.z};
}

/// A light and its bounds.
struct Item : LightBounds {
    std::uint32_t light = 0;
};

struct Box {
    double lo[3] = {infinite, infinite, infinite}, hi[3] = {-infinite, -infinite, -infinite};

    void add(const Vec3d& p, double radius = 0)
    {
        const auto x = axes(p);
        for (std::size_t i = 0; i < 3; ++i) {
            lo[i] = std::min(lo[i], x[i] - radius);
            hi[i] = std::max(hi[i], x[i] + radius);
        }
    }
    void add(const Box& b)
    {
        for (std::size_t i = 0; i < 3; ++i) lo[i] = std::min(lo[i], b.lo[i]), hi[i] = std::max(hi[i], b.hi[i]);
    }
    double extent(std::size_t axis) const { return hi[axis] - lo[axis]; }
    Vec3d center() const { return {(lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2, (lo[2] + hi[2]) / 2}; }
    /// Surface area plus a tenth of the squared diagonal, so that lights on a line have a size too.
    double area() const
    {
        const double x = extent(0), y = extent(1), z = extent(2);
        return 2 * (x * y + y * z + z * x) + 0.1 * (x * x + y * y + z * z);
    }
};

/// Sums over a set of lights, for the evaluation of splits.
struct Sums {
    Box box;
    Vec3d axis;
    double intensity = 0;

    void add(const Item& item)
    {
        box.add(item.ball.center, item.ball.radius);
        axis = axis + item.axis * item.intensity;
        intensity += item.intensity;
    }
    void add(const Sums& s)
    {
        box.add(s.box);
        axis = axis + s.axis;
        intensity += s.intensity;
    }
    /// Cost of a set by Conty Estevez and Kulla 2018, section 4.4: intensity, times size, times a measure of emission
    /// directions. That measure goes from pi (equal normals) to 4 pi; the length of the mean normal stands for the
    /// spread, because it is additive and needs no angles.
    double cost() const
    {
        if (!(intensity > 0)) return 0;
        return intensity * box.area() * pi * (4 - 3 * std::min(length(axis) / intensity, 1.0));
    }
};

LightBounds bounds_of(const LightRecord& light, double power, const Shutter& shutter)
{
    LightBounds bounds;
    visit_light(light, [&](const auto& own) {
        bounds.ball = own.ball(shutter);
        own.set_emission(bounds, light, power);
    });
    // Degenerate lights have no normal.
    if (!std::isfinite(dot(bounds.axis, bounds.axis))) bounds.axis = {}, bounds.cos_normals = -1;
    return bounds;
}

/// Cosine of the sum of two angles given by their cosines; -1 if the sum is 180 degrees or more.
double cosine_of_sum(double a, double b)
{
    return a + b <= 0 ? -1 : a * b - std::sqrt((1 - a * a) * (1 - b * b));
}

/// Replaces a light's bounds by those of its motion.
void set_motion_bounds(Item& item, const LightExtent& extent)
{
    item.ball.center = extent.center;
    item.ball.radius = extent.radius;
    if (item.cos_normals <= -1) return;
    item.axis = extent.axis;
    item.cos_normals = cosine_of_sum(item.cos_normals, std::min(extent.cos_turned, 1.0));
    if (item.cos_normals <= -1) item.axis = {};
}

/// Builds the wide tree top down by binned splits.
class TreeBuilder {
public:
    TreeBuilder(LightTables& t, const std::vector<double>& powers, double open, double close,
                const std::vector<LightExtent>& extents)
        : t_(t)
    {
        items_.reserve(t.positioned_lights);
        double all = 0;
        auto extent = extents.begin();
        for (std::uint32_t i = 0; i < t.positioned_lights; ++i) {
            while (extent != extents.end() && extent->light < i) ++extent;
            if (!(powers[i] > 0)) continue;
            Item& item = items_.emplace_back(Item{bounds_of(t.lights[i], powers[i], {open, close}), i});
            if (extent != extents.end() && extent->light == i) set_motion_bounds(item, *extent);
            all += item.intensity;
        }
        for (Item& item : items_) item.intensity /= all;
    }

    void run()
    {
        t_.light_tree.clear();
        if (!items_.empty()) build(0, std::uint32_t(items_.size()), no_index, 0);
    }

private:
    /// A range of items that becomes a child of a node.
    struct Range {
        std::uint32_t begin, end;
        double cost;
        std::uint32_t size() const { return end - begin; }
    };
    static constexpr int bins = 12;
    /// From this level of the tree on, sets are halved by count, which bounds the depth of the tree for any input.
    static constexpr int deepest_judged = 12;

    /// Large sets are evaluated by a subset of at most this many items.
    static constexpr std::size_t max_judged = 4096;
    static std::size_t stride(std::span<const Item> items) { return (items.size() + max_judged - 1) / max_judged; }

    std::span<Item> items(const Range& r) { return std::span(items_).subspan(r.begin, r.size()); }

    Range range(std::uint32_t begin, std::uint32_t end)
    {
        Range r{begin, end, 0};
        Sums sums;
        const auto all = items(r);
        for (std::size_t i = 0; i < all.size(); i += stride(all)) sums.add(all[i]);
        r.cost = sums.cost() * double(stride(all));
        return r;
    }

    /// Builds the node of a range of items and its subtree; returns the node's index.
    std::uint32_t build(std::uint32_t begin, std::uint32_t end, std::uint32_t parent, int level)
    {
        const std::uint32_t number = std::uint32_t(t_.light_tree.size());
        t_.light_tree.emplace_back().parent = parent;
        const std::vector<Range> children = divide(begin, end, level);
        LightNode node = t_.light_tree[number];
        node.count = std::uint32_t(children.size());
        for (std::uint32_t slot = 0; slot < LightNode::width; ++slot) {
            clear(node, slot);
            if (slot >= node.count) continue;
            const Range& r = children[slot];
            put_bounds(node, slot, items(r));
            const std::uint32_t place = number * LightNode::width + slot;
            if (r.size() == 1) {
                const std::uint32_t light = items_[r.begin].light;
                t_.lights[light].tree_place = place;
                node.child[slot] = light | LightNode::is_light;
            } else
                node.child[slot] = build(r.begin, r.end, place, level + 1);
        }
        t_.light_tree[number] = node;
        return number;
    }

    /// Divides a range into up to 16 children by repeated splits of the most expensive one; ranges that don't fit into
    /// a node are split first.
    std::vector<Range> divide(std::uint32_t begin, std::uint32_t end, int level)
    {
        std::vector<Range> parts;
        if (end - begin <= LightNode::width) {
            for (std::uint32_t i = begin; i < end; ++i) parts.push_back({i, i + 1, 0});
            return parts;
        }
        const std::uint32_t rest = move_strongest_first(begin, end);
        for (std::uint32_t i = begin; i < rest; ++i) parts.push_back({i, i + 1, 0});
        parts.push_back(range(rest, end));
        while (parts.size() < LightNode::width) {
            const auto larger = [](const Range& a, const Range& b) {
                const auto rank = [](const Range& r) {
                    return std::tuple(r.size() > LightNode::width, r.size() > 1, r.cost);
                };
                return rank(a) < rank(b);
            };
            const auto largest = std::max_element(parts.begin(), parts.end(), larger);
            const std::uint32_t middle = level < deepest_judged ? split(*largest) : (largest->begin + largest->end) / 2;
            const std::uint32_t last = largest->end;
            *largest = range(largest->begin, middle);
            parts.insert(largest + 1, range(middle, last));
        }
        return parts;
    }

    /// Moves lights with more than a child's mean intensity to the front, at most half of a node's children; they
    /// become direct children, so that selecting them takes no descent. Returns the start of the others.
    std::uint32_t move_strongest_first(std::uint32_t begin, std::uint32_t end)
    {
        constexpr std::uint32_t most = LightNode::width / 2;
        const auto first = items_.begin() + begin, last = items_.begin() + end;
        double all = 0;
        for (auto item = first; item != last; ++item) all += item->intensity;
        std::partial_sort(first, first + most, last, [](const Item& a, const Item& b) {
            return std::tuple(-a.intensity, a.light) < std::tuple(-b.intensity, b.light);
        });
        const auto rest =
            std::find_if(first, first + most, [&](const Item& i) { return !(i.intensity > all / LightNode::width); });
        return std::uint32_t(rest - items_.begin());
    }

    struct Split {
        std::size_t axis = 0;
        int bin = 0;
        double cost = infinite;
    };

    /// Partitions the items of a range in place; returns the start of the second part.
    std::uint32_t split(const Range& r)
    {
        Box centers;
        for (const Item& item : items(r)) centers.add(item.ball.center);
        const Split best = best_split(items(r), centers);
        if (best.cost == infinite) return (r.begin + r.end) / 2;  // all centers coincide, so the range is halved
        const auto middle = std::partition(items(r).begin(), items(r).end(), [&](const Item& item) {
            return bin_of(item, centers, best.axis) <= best.bin;
        });
        return r.begin + std::uint32_t(middle - items(r).begin());
    }

    static int bin_of(const Item& item, const Box& centers, std::size_t axis)
    {
        const double at = (axes(item.ball.center)[axis] - centers.lo[axis]) / centers.extent(axis);
        return std::min(int(at * bins), bins - 1);
    }

    static Split best_split(std::span<const Item> items, const Box& centers)
    {
        Split best;
        const double longest = std::max({centers.extent(0), centers.extent(1), centers.extent(2)});
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!(centers.extent(axis) > 1e-6 * longest)) continue;
            std::array<Sums, bins> bin{};
            std::array<bool, bins> used{};
            for (std::size_t i = 0; i < items.size(); i += stride(items)) {
                const auto b = std::size_t(bin_of(items[i], centers, axis));
                bin[b].add(items[i]), used[b] = true;
            }
            std::array<double, bins> after{};  // cost of the items in all bins after each bin
            Sums sums;
            for (std::size_t b = bins - 1; b > 0; --b) sums.add(bin[b]), after[b - 1] = sums.cost();
            sums = {};
            // Thin slices of elongated boxes are penalized as in Conty Estevez and Kulla 2018.
            const double stretched = longest / centers.extent(axis);
            for (std::size_t b = 0; b + 1 < bins; ++b) {
                sums.add(bin[b]);
                const double cost = stretched * (sums.cost() + after[b]);
                if (used[b] && cost < best.cost) best = {axis, int(b), cost};
            }
        }
        return best;
    }

    static void clear(LightNode& n, std::uint32_t slot)
    {
        for (LightNode::Column* c :
             {&n.x, &n.y, &n.z, &n.axis_x, &n.axis_y, &n.axis_z, &n.sin_normals, &n.cos_emission, &n.intensity})
            (*c)[slot] = 0;
        n.radius[slot] = n.cos_normals[slot] = n.back[slot] = 1;
        n.child[slot] = LightNode::is_light;
    }

    static void put_bounds(LightNode& n, std::uint32_t slot, std::span<const Item> items)
    {
        put_ball_around(n, slot, items);
        set_normal_cone(n, slot, items);
        double intensity = 0;
        for (const Item& item : items) intensity += item.intensity;
        n.intensity[slot] = float(intensity);
    }

    static void put_ball_around(LightNode& n, std::uint32_t slot, std::span<const Item> items)
    {
        Box box;
        for (const Item& item : items) box.add(item.ball.center, item.ball.radius);
        const Vec3d center = items.size() == 1 ? items[0].ball.center : box.center();
        double radius = 0;
        for (const Item& item : items) radius = std::max(radius, length(item.ball.center - center) + item.ball.radius);
        n.x[slot] = float(center.x), n.y[slot] = float(center.y), n.z[slot] = float(center.z);
        n.radius[slot] = float(radius * (1 + radius_slack) + position_slack * length(center) + min_radius);
    }

    static void set_normal_cone(LightNode& n, std::uint32_t slot, std::span<const Item> items)
    {
        bool back = false;
        double cos_emission = 1;
        for (const Item& item : items) {
            back |= item.emits_back;
            cos_emission = std::min(cos_emission, item.cos_emission);
        }
        // Axes of two-sided lights may be reversed; they are turned to the side of the first item's axis.
        const auto turned = [&](const Item& item, const Vec3d& to) {
            return item.emits_back && dot(item.axis, to) < 0 ? -item.axis : item.axis;
        };
        Vec3d sum;
        for (const Item& item : items) sum = sum + turned(item, items[0].axis) * item.intensity;
        const double size = length(sum);
        const Vec3d axis = size > 0 ? sum * (1 / size) : Vec3d{0, 0, 1};
        double cos_normals = size > 0 ? 1 : -1;
        for (const Item& item : items) {
            const double c = std::clamp(dot(turned(item, axis), axis), -1.0, 1.0);
            cos_normals = std::min(cos_normals, cosine_of_sum(c, item.cos_normals));
        }
        cos_normals = std::max(cos_normals - cosine_slack, -1.0);
        n.axis_x[slot] = float(axis.x), n.axis_y[slot] = float(axis.y), n.axis_z[slot] = float(axis.z);
        n.cos_normals[slot] = float(cos_normals);
        n.sin_normals[slot] = float(std::sqrt(std::max(1 - cos_normals * cos_normals, 0.0)));
        n.cos_emission[slot] = float(cos_emission);
        n.has_narrow |= cos_emission > 0;
        n.back[slot] = back ? -1 : 1;
    }

    LightTables& t_;
    std::vector<Item> items_;
};

}  // namespace

void build_light_tree(LightTables& t, const std::vector<double>& powers, double open, double close,
                      const std::vector<LightExtent>& extents)
{
    TreeBuilder(t, powers, open, close, extents).run();
}

}  // namespace fathom
