// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "geometry/bvh/builder/leaf_data.h"
#include "geometry/bvh/compare_with_brute_force.h"

namespace fathom {
namespace {

Vec4f point_with(Vec3f p, float radius)
{
    return {p.x, p.y, p.z, radius};
}

/// Makes world-space curves and points: shape 0 is round cubic, 1 cubic ribbons, 2 round linear, 3 linear ribbons.
GeometryTables curves(std::size_t n, float radius, float size, float thickness, Vec3f offset = {})
{
    Random random(n + 100);
    GeometryTables tables = empty_tables();
    tables.shapes.resize(5);
    tables.shapes[1].flags = ShapeRecord::ribbons;
    tables.shapes[2].flags = ShapeRecord::linear_curves;
    tables.shapes[3].flags = ShapeRecord::linear_curves | ShapeRecord::ribbons;
    for (std::uint32_t shape = 0; shape < 4; ++shape)
        for (std::size_t i = 0; i < n; ++i) {
            CurveRecord curve;
            curve.first_point = std::uint32_t(tables.curve_points.size());
            curve.pieces = shape < 2 ? 1u << random.below(6) : 1;
            tables.curves.push_back(curve);
            tables.shape_of_primitive.push_back(shape);
            Vec3f p = plus(random.point(radius), offset);
            for (int k = 0; k < (shape < 2 ? 4 : 2); ++k) {
                tables.curve_points.push_back(point_with(p, random.uniform(0, thickness)));
                p = plus(p, random.point(size));
            }
        }
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f p = plus(random.point(radius), offset);
        tables.points.push_back(point_with(p, random.uniform(0, thickness)));
        tables.shape_of_primitive.push_back(4);
    }
    return tables;
}

TEST(Curves, against_force)
{
    for (std::size_t n : {1, 2, 7}) compare_with_brute_force(curves(n, 1, 1, 0.5f), 1, 10'000, "few");
    compare_with_brute_force(curves(100, 100, 20, 3), 100, 10'000, "thick");
    compare_with_brute_force(curves(300, 100, 30, 0.2f), 100, 5'000, "hair");
    compare_with_brute_force(curves(100, 1e-12f, 1e-13f, 1e-13f), 1e-12f, 5'000, "tiny");
    compare_with_brute_force(curves(100, 1e8f, 1e7f, 1e6f), 1e8f, 5'000, "huge");
    compare_with_brute_force(curves(100, 1, 0.3f, 0.1f, {3e4f, -1e5f, 2e4f}), 1.5e5f, 5'000, "far away");
}

TEST(Curves, degenerate)
{
    GeometryTables tables = curves(40, 10, 3, 0.5f);
    Random random(3);
    // Some curves are degenerate: points, zero radii, radii that vanish, one sphere inside the other, and a hairpin.
    for (std::size_t i = 0; i < 160; i += 4) {
        Vec4f* p = &tables.curve_points[i];
        switch (i / 4 % 5) {
            case 0:
                p[1] = p[2] = p[3] = p[0];
                break;
            case 1:
                p[0].w = p[1].w = p[2].w = p[3].w = 0;
                break;
            case 2:
                p[0].w = 0;
                break;
            case 3:
                p[1] = p[2] = p[3] = p[0], p[3].w = 5 * p[0].w, p[3].x += 0.01f;
                break;
            default:
                p[2] = p[1], p[3] = p[0];
                break;
        }
    }
    compare_with_brute_force(tables, 10, 10'000, "degenerate");
    for (Vec4f& p : tables.curve_points) p.w = 0;
    tables.points.clear();
    tables.shape_of_primitive.resize(tables.primitive_count());
    Bvh bvh;
    bvh.build(tables);
    EXPECT_EQ(bvh.statistics().leaf_primitives, 0u);
}

TEST(Curves, not_finite)
{
    GeometryTables tables = curves(5, 1, 1, 0.5f);
    Bvh whole, bvh;
    whole.build(tables);
    const std::size_t pieces = tables.curves[1].pieces;
    tables.curve_points[5].y = std::numeric_limits<float>::quiet_NaN();
    tables.points[2].w = std::numeric_limits<float>::infinity();
    bvh.build(tables);
    // The first piece of the broken segment starts at its first point and is invalid too, like the last one.
    EXPECT_EQ(bvh.statistics().leaf_primitives, whole.statistics().leaf_primitives - pieces - 1);
}

/// Instances the five shapes of 30 primitives each; some instances move.
void place(GeometryTables& tables)
{
    std::uint32_t first = tables.first_curve();
    for (std::uint32_t i = 0; i < 5; ++i) {
        tables.shapes[i].flags |= ShapeRecord::only_instanced;
        tables.shapes[i].first_primitive = first;
        first += 30;
    }
    tables.shutter_close = 1;
    Random random(8);
    for (std::uint32_t i = 0; i < 60; ++i) {
        const Vec3f p = random.point(20), axis = random.direction();
        InstanceRecord instance;
        instance.mesh_shape = instance.shape = i % 5;
        const Transform t = Transform::translate({p.x, p.y, p.z}) * Transform::rotate({axis.x, axis.y, axis.z}, 2) *
                            Transform::scale({4, i % 3 ? -2. : 7., 1});
        instance.object_from_render = rounded(t.inverse());
        if (i % 2) {
            instance.poses = std::uint32_t(tables.poses.size()) << 8 | 2;
            PoseRecord pose;
            pose.translation[0] = p.x, pose.translation[1] = p.y, pose.translation[2] = p.z;
            pose.rotation[3] = 1;
            pose.stretch[0] = 4, pose.stretch[3] = 2, pose.stretch[5] = 1;
            tables.poses.push_back(pose);
            pose.time = 1;
            pose.translation[1] += 5;
            tables.poses.push_back(pose);
        }
        tables.instances.push_back(instance);
    }
}

TEST(Curves, placed_and_moving)
{
    GeometryTables tables = curves(30, 1, 0.5f, 0.1f);
    place(tables);
    compare_with_brute_force(tables, 20, 5'000, "placed");
}

/// Curves with moving control points and radii; bit i of still makes shape i static.
GeometryTables moving_curves(GeometryTables tables, std::vector<float> times, float way, float thickness,
                             std::uint32_t still = 0)
{
    Random random(times.size());
    std::vector<Vec4f> points;
    for (std::uint32_t shape = 0; shape < 4; ++shape) {
        std::size_t low = tables.curve_points.size(), high = 0;
        const std::size_t begin = points.size();
        for (std::size_t i = 0; i < tables.curves.size(); ++i) {
            if (tables.shape_of_primitive[tables.first_curve() + i] != shape) continue;
            std::uint32_t& first = tables.curves[i].first_point;
            low = std::min<std::size_t>(low, first);
            high = std::max<std::size_t>(high, first + (shape < 2 ? 4u : 2u));
            first = std::uint32_t(first - low + begin);
        }
        if (high == 0) continue;
        points.insert(points.end(), tables.curve_points.begin() + std::ptrdiff_t(low),
                      tables.curve_points.begin() + std::ptrdiff_t(high));
        if (still >> shape & 1) continue;
        const std::size_t n = high - low;
        tables.shapes[shape].moving_vertices = std::uint32_t(n);
        for (std::size_t i = 0; i < n * (times.size() - 1); ++i) {
            const Vec4f before = points[points.size() - n];
            const Vec3f p = plus({before.x, before.y, before.z}, random.point(way));
            points.push_back(point_with(p, random.uniform(0, thickness)));
        }
    }
    tables.curve_points = points;
    tables.vertex_times = times;
    tables.shutter_open = times.front(), tables.shutter_close = times.back();
    return tables;
}

TEST(MovingCurves, against_force)
{
    for (std::size_t n : {1, 2, 7})
        compare_with_brute_force(moving_curves(curves(n, 1, 1, 0.5f), {0, 1}, 0.5f, 0.5f), 1, 10'000, "few");
    compare_with_brute_force(moving_curves(curves(100, 100, 20, 3), {0, 1}, 10, 3), 100, 4'000, "thick");
    compare_with_brute_force(moving_curves(curves(200, 100, 30, 0.2f), {0, 0.25f, 1}, 100, 0.2f), 100, 2'000, "hair");
    compare_with_brute_force(moving_curves(curves(100, 100, 20, 3), {0.25f, 0.5f}, 10, 3), 100, 2'000, "other times");
    compare_with_brute_force(moving_curves(curves(100, 100, 20, 3), {0, 1}, 10, 3, 0b0110), 100, 4'000,
                             "beside still ones");
    compare_with_brute_force(moving_curves(curves(100, 1e-12f, 1e-13f, 1e-13f), {0, 1}, 1e-13f, 1e-13f), 1e-12f, 2'000,
                             "tiny");
    compare_with_brute_force(moving_curves(curves(100, 1, 0.3f, 0.1f, {3e4f, -1e5f, 2e4f}), {0, 1}, 0.3f, 0.1f), 1.5e5f,
                             2'000, "far away");
}

/// The tables at one time, without motion.
GeometryTables stopped(const GeometryTables& tables, double time)
{
    GeometryTables still = tables;
    const std::vector<float>& times = tables.vertex_times;
    std::size_t key = 0;
    while (key + 2 < times.size() && double(times[key + 1]) <= time) ++key;
    const double f = (time - double(times[key])) / (double(times[key + 1]) - double(times[key]));
    const auto mean = [&](float a, float b) { return float(double(a) + (double(b) - double(a)) * f); };
    for (std::size_t i = 0; i < tables.curves.size(); ++i) {
        const std::uint32_t shape = tables.shape_of_primitive[tables.first_curve() + i],
                            n = tables.shapes[shape].moving_vertices;
        const std::size_t count = tables.shapes[shape].flags & ShapeRecord::linear_curves ? 2 : 4;
        for (std::size_t k = 0; n > 0 && k < count; ++k) {
            const std::size_t at = tables.curves[i].first_point + k;
            const Vec4f &a = tables.curve_points[at + key * n], &b = tables.curve_points[at + (key + 1) * n];
            still.curve_points[at] = {mean(a.x, b.x), mean(a.y, b.y), mean(a.z, b.z), mean(a.w, b.w)};
        }
    }
    for (ShapeRecord& shape : still.shapes) shape.moving_vertices = 0;
    still.vertex_times.clear();
    still.shutter_close = still.shutter_open;
    return still;
}

/// Chains of segments with shared points, round: shape 0 cubic, shape 2 linear.
GeometryTables chains(std::size_t n)
{
    Random random(n);
    GeometryTables tables = empty_tables();
    tables.shapes.resize(3);
    tables.shapes[2].flags = ShapeRecord::linear_curves;
    for (const std::uint32_t shape : {0u, 2u})
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint32_t step = shape == 0 ? 3 : 1;
            Vec3f p = random.point(10);
            for (std::uint32_t k = 0; k <= 3 * step; ++k) {
                if (k % step == 0 && k < 3 * step) {
                    tables.curves.push_back({std::uint32_t(tables.curve_points.size()), shape == 0 ? 8u : 1u, 0, 1});
                    tables.shape_of_primitive.push_back(shape);
                }
                tables.curve_points.push_back(point_with(p, random.uniform(0.2f, 0.5f)));
                p = plus(p, random.point(2));
            }
        }
    return tables;
}

/// At each time, moving curves equal static curves with interpolated control points, for all kinds, also round curves
/// as solids.
TEST(MovingCurves, are_curves_of_points_in_between)
{
    GeometryTables all = moving_curves(curves(60, 10, 6, 0.6f), {0, 0.375f, 1}, 4, 0.6f);
    GeometryTables solids = moving_curves(chains(25), {0, 0.375f, 1}, 2, 0.5f);
    for (ShapeRecord& shape : solids.shapes) shape.flags |= ShapeRecord::solid_curves;
    for (const GeometryTables& tables : {all, solids}) {
        Bvh moving;
        moving.build(tables);
        int hits = 0, other = 0;
        for (const float time : {0.f, 0.2f, 0.375f, 0.7f, 1.f}) {
            Rays rays = difficult_rays(tables, 10, lanes == 1 ? 1'000 : 4'000, 9);
            for (float& t : rays.time) t = time;
            const Hits then = cast(moving, rays, false);
            const GeometryTables still = stopped(tables, double(time));
            Bvh bvh;
            bvh.build(still);
            const Hits now = cast(bvh, rays, false);
            for (std::size_t i = 0; i < rays.count(); ++i) {
                if (then.primitive[i] == no_index && now.primitive[i] == no_index) continue;
                ++hits;
                const float near = std::abs(then.t[i] - now.t[i]);
                // Grazing rays and rays that start on a surface may go either way.
                other += then.primitive[i] != now.primitive[i] || !(near <= 1e-3f * (1 + now.t[i])) ||
                         std::abs(then.u[i] - now.u[i]) > 0.01f;
            }
        }
        EXPECT_GT(hits, lanes == 1 ? 1'000 : 4'000);
        EXPECT_LT(other, hits / 200);
    }
}

TEST(MovingCurves, placed_by_what_moves)
{
    GeometryTables tables = moving_curves(curves(30, 1, 0.5f, 0.1f), {0, 0.5f, 1}, 0.3f, 0.1f);
    place(tables);
    compare_with_brute_force(tables, 20, 2'000, "placed");
}

TEST(MovingCurves, degenerate_and_not_finite)
{
    GeometryTables tables = moving_curves(curves(10, 1, 1, 0.5f), {0, 1}, 0.5f, 0.5f);
    // Radii are zero at both keys, at the first, or at the last, and one curve is a point at the first key.
    const std::uint32_t n = tables.shapes[0].moving_vertices;
    Vec4f* const p = tables.curve_points.data();
    for (std::size_t k = 0; k < 4; ++k) {
        p[k].w = p[n + k].w = p[4 + k].w = p[n + 8 + k].w = 0;
        p[12 + k] = p[12];
    }
    compare_with_brute_force(tables, 1, 10'000, "degenerate");
    Bvh whole, bvh;
    whole.build(tables);
    p[n + 4].y = std::numeric_limits<float>::quiet_NaN();
    bvh.build(tables);
    EXPECT_EQ(bvh.statistics().leaf_primitives, whole.statistics().leaf_primitives - tables.curves[1].pieces);
}

/// Motion bounds contain the moving curves and are tight.
TEST(MovingCurves, boxes_follow)
{
    const GeometryTables tables = curves(2'000, 100, 5, 0.5f);
    GeometryTables flying = moving_curves(tables, {0, 1}, 0, 0);
    for (std::size_t shape = 0; shape < 4; ++shape) {
        const std::size_t n = flying.shapes[shape].moving_vertices;
        const std::size_t first = flying.curves[2'000 * shape].first_point;
        for (std::size_t i = first; i < first + n; ++i) {
            const Vec4f& p = flying.curve_points[i];
            flying.curve_points[i + n] = {p.x + 30, p.y + 20, p.z - 10, p.w};
        }
    }
    GeometryTables still = flying;
    still.vertex_times.clear();
    for (ShapeRecord& shape : still.shapes) shape.moving_vertices = 0;
    // The points would not move, so they are removed.
    flying.points.clear(), still.points.clear();
    flying.shape_of_primitive.resize(flying.primitive_count()),
        still.shape_of_primitive.resize(still.primitive_count());
    Bvh a, b;
    a.build(still);
    b.build(flying);
    EXPECT_LT(b.statistics().cost, 1.02 * a.statistics().cost);
}

/// Result of one ray against one curve piece.
struct PieceHit {
    bool hit;
    float t, w;
};
PieceHit intersect_piece(Vec3f a, float ra, Vec3f b, float rb, Vec3f o, Vec3f d, bool ribbon)
{
    alignas(64) float ts[lanes], ws[lanes];
    Float t(0.f), w(0.f);
    const CurvePiece piece{Vec3(a), Vec3(b), Float(ra), Float(rb)};
    const Vec3 along = Vec3(b) - Vec3(a);
    const Mask m = ribbon ? intersect_ribbon_piece({piece, along, along}, Vec3(o), Vec3(d), Float(infinity), t, w)
                          : intersect_round_piece(piece, Vec3(o), Vec3(d), Float(infinity), t, w);
    store(ts, t), store(ws, w);
    return {(mask_bits(m) & 1) != 0, ts[0], ws[0]};
}

/// Sphere tracing of the swept solid in double precision: returns the first distance inside, refined by bisection.
double march(Vec3f a, float ra, Vec3f b, float rb, Vec3f o, Vec3f d, double far)
{
    const auto outside = [&](double t) {
        const double p[3] = {o.x + t * d.x - a.x, o.y + t * d.y - a.y, o.z + t * d.z - a.z};
        const double e[3] = {double(b.x) - a.x, double(b.y) - a.y, double(b.z) - a.z};
        const double ee = e[0] * e[0] + e[1] * e[1] + e[2] * e[2], pe = p[0] * e[0] + p[1] * e[1] + p[2] * e[2];
        const double g = double(rb) - ra, A = ee - g * g;
        const double w = A > 0 ? std::clamp((pe + g * ra) / A, 0.0, 1.0) : (g > 0 ? 1 : 0);
        double d2 = 0;
        for (int i = 0; i < 3; ++i) d2 += (p[i] - w * e[i]) * (p[i] - w * e[i]);
        return std::sqrt(d2) - (ra + w * g);
    };
    if (outside(0) <= 0) return -1;  // the ray starts inside
    for (double t = 0; t < far;) {
        // The step is below the true distance, but not by much.
        const double next = t + std::max(0.2 * outside(t), 1e-5);
        if (outside(next) <= 0) {
            double low = t, high = next;
            for (int i = 0; i < 50; ++i) (outside(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
            return low;
        }
        t = next;
    }
    return far;
}

TEST(Curves, round_pieces_are_swept_balls)
{
    Random random(4);
    int hits = 0, unsure = 0;
    for (int i = 0; i < 10'000; ++i) {
        const Vec3f a = random.point(1), b = plus(a, random.point(random.below(2) ? 1.f : 0.05f));
        const float ra = random.uniform(0, 0.2f), rb = random.below(4) ? random.uniform(0, 0.2f) : 0;
        const Vec3f o = random.point(4);
        const Vec3f between = plus(times(a, random.uniform()), times(b, 0.5f));
        const Vec3f target = plus(between, random.point(0.3f));
        const Vec3f d = unit_towards(o, target);
        const double expected = march(a, ra, b, rb, o, d, 12);
        if (expected < 0) continue;
        const PieceHit met = intersect_piece(a, ra, b, rb, o, d, false);
        // Grazing rays may hit or miss.
        if (met.hit != (expected < 12)) {
            ++unsure;
            continue;
        }
        if (!met.hit) continue;
        ++hits;
        // The distance t is inexact at grazing angles; the check below uses the distance from the surface.
        EXPECT_NEAR(met.t, expected, 2e-3) << i;
        const double w = met.w, g = double(rb) - ra;
        double d2 = 0;
        const float as[3] = {a.x, a.y, a.z}, bs[3] = {b.x, b.y, b.z}, os[3] = {o.x, o.y, o.z}, ds[3] = {d.x, d.y, d.z};
        for (int k = 0; k < 3; ++k) {
            const double c = as[k] + w * (double(bs[k]) - as[k]), p = os[k] + double(met.t) * ds[k];
            d2 += (p - c) * (p - c);
        }
        EXPECT_NEAR(std::sqrt(d2), ra + w * g, 1e-5) << i;
    }
    EXPECT_GT(hits, 1'500);
    EXPECT_LT(unsure, 20);
}

/// The share of parallel rays that hit a ribbon gives its projected area for any orientation.
TEST(Curves, area_of_ribbons_and_capsules)
{
    Random random(5);
    for (bool ribbon : {true, false}) {
        const Vec3f a{-0.6f, 0.2f, 0.1f}, b{0.5f, -0.3f, -0.4f};
        const float ra = 0.25f, rb = ribbon ? 0.1f : 0.25f;
        const double dx = 1.1, dy = -0.5, length = std::sqrt(dx * dx + dy * dy);
        int hits = 0;
        constexpr int n = 200'000;
        for (int i = 0; i < n; ++i)
            hits += intersect_piece(a, ra, b, rb, {random.uniform(-1, 1), random.uniform(-1, 1), 5}, {0, 0, -1}, ribbon)
                        .hit;
        const double expected = ribbon ? length * (ra + rb) : length * 2 * ra + 3.14159265 * ra * ra;
        const double share = expected / 4;
        EXPECT_NEAR(double(hits) / n, share, 4 * std::sqrt(share * (1 - share) / n));
    }
}

std::uint64_t hash_of_hits(const GeometryTables& tables)
{
    Bvh bvh;
    bvh.build(tables);
    Rays rays = difficult_rays(tables, 100, 20'000, 15);
    return hash_of(cast(bvh, rays, true), rays.count(), tables.first_point(), 0);
}

TEST(Curves, the_same_bits_everywhere)
{
    EXPECT_EQ(hash_of_hits(curves(500, 100, 20, 1)), 18107152515193929170u);
    EXPECT_EQ(hash_of_hits(moving_curves(curves(500, 100, 20, 1), {0, 0.25f, 1}, 10, 1)), 7102588432208725652u);
}

}  // namespace
}  // namespace fathom
