// SPDX-License-Identifier: Apache-2.0
#include "geometry/flat/flat.h"

#include <gtest/gtest.h>

#include "geometry/bvh/plain.h"
#include "geometry/bvh/rays_and_scenes.h"

// Tests of flat scenes, traced as lists: merged boxes, and shadow lists without shapes that can't block a ray, against
// double-precision brute force.
namespace fathom {
namespace {

struct Found {
    double t = plain::nothing;
    std::uint32_t primitive = no_index;
};

Found nearest(const GeometryTables& tables, Vec3d o, Vec3d d, double time, double grow)
{
    Found found;
    const auto take = [&](double t, std::uint32_t primitive) {
        if (t < found.t) found = {t, primitive};
    };
    for (std::uint32_t i = 0; i < tables.triangle_count(); ++i) {
        const auto corner = [&](std::uint32_t k) { return plain::wide(tables.positions[tables.triangles[3 * i + k]]); };
        take(plain::intersect_triangle(corner(0), corner(1), corner(2), o, d, grow).t, i);
    }
    for (std::uint32_t i = 0; i < tables.quads.size(); ++i) {
        const QuadRecord& q = tables.quads[i];
        take(plain::intersect_parallelogram(plain::wide(q.corner), plain::wide(q.edge_u), plain::wide(q.edge_v), o, d,
                                            grow)
                 .t,
             tables.first_quad() + i);
    }
    for (std::uint32_t i = 0; i < tables.spheres.size(); ++i) {
        const SphereRecord& s = tables.spheres[i];
        take(plain::intersect_sphere(plain::wide(s.center) + plain::wide(s.motion) * time, std::abs(double(s.radius)),
                                     o, d, grow),
             tables.first_sphere() + i);
    }
    for (std::uint32_t i = 0; i < tables.disks.size(); ++i) {
        const DiskRecord& q = tables.disks[i];
        take(plain::intersect_disk(plain::wide(q.center), plain::wide(q.normal), q.radius, o, d, grow),
             tables.first_disk() + i);
    }
    return found;
}

void add_box(GeometryTables& tables, Vec3f lo, Vec3f hi, int faces)
{
    const Vec3f x{hi.x - lo.x, 0, 0}, y{0, hi.y - lo.y, 0}, z{0, 0, hi.z - lo.z};
    const QuadRecord all[6] = {{lo, z, y},          {plus(lo, x), y, z}, {lo, x, z},
                               {plus(lo, y), z, x}, {lo, y, x},          {plus(lo, z), x, y}};
    for (int i = 0; i < faces; ++i) tables.quads.push_back(all[(i * 5 + faces) % 6]);
}

constexpr int oriented_boxes = 3;

/// Adds a parallelepiped with the given number of faces, opposite pairs first. The corner and edge order of each face
/// is random.
void add_turned_box(GeometryTables& tables, Random& random, Vec3f origin, const Vec3f (&edges)[3], int faces)
{
    for (int i = 0; i < faces; ++i) {
        const int axis = i / 2;
        Vec3f corner = i % 2 ? plus(origin, edges[axis]) : origin, u = edges[(axis + 1) % 3], v = edges[(axis + 2) % 3];
        if (random.below(2)) std::swap(u, v);
        if (random.below(2)) corner = plus(corner, u), u = {-u.x, -u.y, -u.z};
        if (random.below(2)) corner = plus(corner, v), v = {-v.x, -v.y, -v.z};
        tables.quads.push_back({corner, u, v});
    }
}

/// A room (closed or open on one side) with boxes, oriented and sheared boxes, quads, triangles and curved shapes.
GeometryTables room(std::uint64_t seed, int faces, bool round)
{
    Random random(seed);
    GeometryTables tables = empty_tables();
    add_box(tables, {-4, -4, -4}, {4, 4, 4}, faces);
    for (int i = 0; i < 3; ++i) {
        const Vec3f lo = random.point(3);
        add_box(tables, lo, plus(lo, {random.uniform(0.3f, 1), random.uniform(0.3f, 1), random.uniform(0.3f, 1)}),
                2 + int(random.below(5)));
    }
    for (int i = 0; i < oriented_boxes; ++i) {
        Vec3f edges[3] = {{0.9f, 0, 0}, {0, 0.9f, 0}, {0, 0, 0.9f}};
        for (Vec3f& edge : edges) edge = plus(edge, random.point(0.4f));
        add_turned_box(tables, random, random.point(3), edges, 4 + i);
    }
    for (int i = 0; i < 3; ++i) {
        const Vec3f lo = random.point(3);
        tables.quads.push_back({lo, {0, random.uniform(0.5f, 1), 0}, {random.uniform(0.5f, 1), 0, 0}});
        tables.quads.push_back({random.point(3), random.point(1), random.point(1)});
    }
    for (int i = 0; i < 4; ++i) {
        const Vec3f a = random.point(3);
        add_triangle(tables, a, plus(a, random.point(1)), plus(a, random.point(1)));
    }
    if (round)
        for (int i = 0; i < 3; ++i) {
            tables.spheres.push_back({random.point(3), random.point(0.5f), random.uniform(0.2f, 0.6f)});
            tables.disks.push_back({random.point(3), random.direction(), random.uniform(0.2f, 0.8f)});
        }
    finish(tables);
    return tables;
}

float lane(Float a, int i)
{
    float x[lanes];
    store(x, a);
    return x[i];
}
std::uint32_t lane(UInt a, int i)
{
    std::uint32_t x[lanes];
    store(x, a);
    return x[i];
}

TEST(Flat, NearestHits)
{
    for (const int faces : {6, 5, 3, 2})
        for (const std::uint64_t seed : {1, 2, 3}) {
            const GeometryTables tables = room(seed, faces, seed != 2);
            ASSERT_TRUE(FlatScene::fits(tables));
            FlatScene flat;
            flat.build(tables, {});
            EXPECT_EQ(int(flat.all.oriented_boxes.size()), oriented_boxes);
            Random random(seed + 100);
            std::vector<std::uint32_t> times_hit(tables.primitive_count());
            int checked = 0;
            for (int i = 0; i < 6000; ++i) {
                const Vec3f o = random.point(random.below(3) ? 4.f : 7.f);
                const Vec3f d = random.below(8) ? random.direction() : Vec3f{0, random.below(2) ? 1.f : -1.f, 0};
                const float time = random.uniform();
                const auto plain = [&](double grow) {
                    return nearest(tables, plain::wide(o), plain::wide(d), time, grow);
                };
                const Found larger = plain(1e-4), smaller = plain(-1e-4);
                // Rays whose result depends on an edge or on the surface at the origin are skipped.
                if (larger.primitive != smaller.primitive || larger.t < 1e-3) continue;
                const Hit hit = flat.closest(tables, {Vec3(o), Vec3(d), Float(infinity), Float(time)});
                ASSERT_EQ(lane(hit.primitive, 0), larger.primitive) << faces << " " << seed << " " << i;
                if (larger.primitive == no_index) continue;
                ASSERT_NEAR(lane(hit.t, 0), smaller.t, 2e-3);
                ++times_hit[larger.primitive];
                ++checked;
            }
            EXPECT_GT(checked, 1500);
            // Every shape is hit, except up to three that are hidden.
            EXPECT_LE(std::count(times_hit.begin(), times_hit.end(), 0u), 3);
        }
}

/// Shadow rays between points in the scene and to lights in it: shapes on the convex hull are omitted without any
/// effect. Rays to infinity test every shape.
TEST(Flat, Shadows)
{
    for (const int faces : {6, 5, 3})
        for (const bool infinite : {false, true})
            for (const std::uint64_t seed : {1, 2, 3}) {
                const GeometryTables tables = room(seed, faces, seed == 3);
                ShadowTargets targets;
                // One light is outside the room, unless the outside targets are at infinity.
                targets.places = {{0.5f, 3.5f, 0.5f}, {-3, 1, 2}, {0, infinite ? 2.0f : 6.0f, 0}};
                targets.infinite = infinite;
                FlatScene flat;
                flat.build(tables, targets);
                Random random(seed + 200);
                int blocked = 0, clear = 0;
                for (int i = 0; i < 6000; ++i) {
                    // Start points lie on surfaces.
                    const Vec3f from = random.point(4);
                    const Vec3f away = random.direction();
                    const float time = random.uniform();
                    const Found start = nearest(tables, plain::wide(from), plain::wide(away), time, 0);
                    if (start.primitive == no_index) continue;
                    const Vec3d on = plain::wide(from) + plain::wide(away) * (start.t * (1 - 1e-4));
                    const Vec3f o{float(on.x), float(on.y), float(on.z)};
                    Vec3f d;
                    float t_max = infinity;
                    if (infinite && random.below(2)) {
                        d = random.direction();
                    } else {
                        const Vec3f to = targets.places[random.below(3)];
                        d = unit_towards(o, to);
                        t_max = float(length(plain::wide(to) - on)) * (1 - 1e-4f);
                    }
                    const auto plain = [&](double grow) {
                        return nearest(tables, plain::wide(o), plain::wide(d), time, grow).t;
                    };
                    const double larger = plain(1e-4), smaller = plain(-1e-4);
                    const auto blocks = [&](double t) { return t < double(t_max); };
                    if (blocks(larger) != blocks(smaller) || larger < 1e-3 || std::abs(smaller - double(t_max)) < 2e-3)
                        continue;
                    const Mask m = flat.occluded(tables, {Vec3(o), Vec3(d), Float(t_max), Float(time)}, Mask(true));
                    ASSERT_EQ(mask_bits(m) & 1, blocks(smaller) ? 1u : 0u)
                        << faces << infinite << seed << ", ray " << i << ": " << smaller << " of " << t_max;
                    (blocks(smaller) ? blocked : clear)++;
                }
                EXPECT_GT(blocked, 300);
                EXPECT_GT(clear, 300);
            }
}

/// Parallelograms become an oriented box if there are four or more faces, two of them opposite.
TEST(Flat, TurnedBoxes)
{
    const Vec3f edges[3] = {{1, 0.5f, 0}, {-0.5f, 1, 0.2f}, {0, 0.3f, 1}};
    const auto found = [&](const std::vector<int>& faces) {
        Random random(5);
        GeometryTables all = empty_tables(), tables = empty_tables();
        add_turned_box(all, random, {1, 2, 3}, edges, 6);
        for (int face : faces) tables.quads.push_back(all.quads[std::size_t(face)]);
        finish(tables);
        FlatScene flat;
        flat.build(tables, {});
        EXPECT_EQ(flat.all.quads.size() + flat.all.oriented_boxes.size() * faces.size(), faces.size());
        return flat.all.oriented_boxes.size();
    };
    EXPECT_EQ(found({0, 1, 2, 3, 4, 5}), 1u);
    EXPECT_EQ(found({4, 2, 5, 0, 3}), 1u);
    EXPECT_EQ(found({1, 2, 3, 4}), 1u);
    EXPECT_EQ(found({0, 1, 2}), 0u);
    EXPECT_EQ(found({1, 3, 5}), 0u);
    // These six parallelograms form no box because two are side by side.
    GeometryTables tables = empty_tables();
    for (int i = 0; i < 6; ++i) tables.quads.push_back({{float(i), float(i), 0}, {1, 1, 0}, {-1, 1, 0}});
    finish(tables);
    FlatScene flat;
    flat.build(tables, {});
    EXPECT_TRUE(flat.all.oriented_boxes.empty());
}

/// The only light, a quad not on the hull, blocks no shadow ray that ends on it.
TEST(Flat, TheOnlyLampIsNoObstacle)
{
    GeometryTables tables = empty_tables();
    add_box(tables, {-4, -4, -4}, {4, 4, 4}, 6);
    tables.quads.push_back({{-1, 3, -1}, {2, 0, 0}, {0, 0, 2}});
    tables.quads.push_back({{0, 1, -1}, {1, 0, 0}, {0, 0, 2}});  // between the light and one half of the floor
    finish(tables);
    ShadowTargets targets;
    targets.places = {{-1, 3, -1}};
    targets.only_primitive = tables.first_quad() + 6;
    FlatScene flat;
    flat.build(tables, targets);
    for (const float x : {-0.9f, -0.5f, 0.5f, 0.9f}) {
        const Ray up{Vec3(Vec3f{x, -4, 0}), Vec3(Vec3f{0, 1, 0}), Float(7.0f), Float(0)};
        EXPECT_EQ(mask_bits(flat.occluded(tables, up, Mask(true))) & 1, x > 0 ? 1u : 0u) << x;
        EXPECT_EQ(mask_bits(flat.occluded(tables, up, Mask(false))) & 1, 0u);
    }
}

/// Small scenes are traced as a list; others need a BVH.
TEST(Flat, Fits)
{
    GeometryTables tables = empty_tables();
    for (std::uint32_t i = 0; i < FlatScene::max_primitives; ++i) tables.quads.push_back({{}, {1, 0, 0}, {0, 1, 0}});
    finish(tables);
    EXPECT_TRUE(FlatScene::fits(tables));
    tables.quads.push_back({{}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_FALSE(FlatScene::fits(tables));
    tables.quads.resize(2);
    for (std::uint32_t i = 0; i < FlatScene::max_triangles; ++i) add_triangle(tables, {}, {1, 0, 0}, {0, 1, 0});
    finish(tables);
    EXPECT_TRUE(FlatScene::fits(tables));
    add_triangle(tables, {}, {1, 0, 0}, {0, 1, 0});
    finish(tables);
    EXPECT_FALSE(FlatScene::fits(tables));
    tables.triangles.clear();
    finish(tables);
    EXPECT_TRUE(FlatScene::fits(tables));
    tables.points.push_back({0, 0, 0, 1});
    EXPECT_FALSE(FlatScene::fits(tables));
}

}  // namespace
}  // namespace fathom
