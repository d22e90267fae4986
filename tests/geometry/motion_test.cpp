// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "geometry/bvh/compare_with_brute_force.h"

namespace fathom {
namespace {

/// A triangle that moves linearly between keys.
void add_moving_triangle(GeometryTables& tables, std::vector<std::vector<Vec3f>>& keys, Vec3f a, Vec3f b, Vec3f c,
                         Random& random, float way)
{
    for (Vec3f v : {a, b, c}) {
        tables.triangles.push_back(std::uint32_t(keys[0].size()));
        for (auto& key : keys) {
            key.push_back(v);
            v = plus(v, random.point(way));
        }
    }
}

/// Completes tables whose first shape has moving vertices, with positions at each of these times.
void finish_moving(GeometryTables& tables, std::uint32_t vertices, const std::vector<float>& times)
{
    tables.shapes[0].moving_vertices = vertices;
    tables.vertex_times = times;
    tables.shutter_open = times.front();
    tables.shutter_close = times.back();
    finish(tables);
}

/// n triangles of one mesh whose vertices move independently.
GeometryTables moving_soup(std::size_t n, float radius, float size, float way, std::vector<float> times,
                           Vec3f offset = {})
{
    Random random(n);
    GeometryTables tables = empty_tables();
    std::vector<std::vector<Vec3f>> keys(times.size());
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f a = plus(random.point(radius), offset);
        const Vec3f b = plus(a, random.point(size)), c = plus(a, random.point(size));
        add_moving_triangle(tables, keys, a, b, c, random, way);
    }
    for (const auto& key : keys) tables.positions.insert(tables.positions.end(), key.begin(), key.end());
    finish_moving(tables, std::uint32_t(3 * n), times);
    return tables;
}

TEST(Motion, vertices)
{
    for (std::size_t n : {1, 2, 17, 100})
        compare_with_brute_force(moving_soup(n, 1, 1, 0.5f, {0, 1}), 1, 10'000, "few");
    compare_with_brute_force(moving_soup(3'000, 100, 10, 5, {0, 1}), 100, 20'000, "soup");
    compare_with_brute_force(moving_soup(3'000, 100, 1, 200, {0, 1}), 100, 10'000, "far and wide");
    compare_with_brute_force(moving_soup(3'000, 100, 10, 5, {0, 0.1f, 0.5f, 0.75f, 1}), 100, 20'000, "five keys");
    compare_with_brute_force(moving_soup(2'000, 1e-12f, 1e-13f, 1e-13f, {0, 1}), 1e-12f, 10'000, "tiny");
    compare_with_brute_force(moving_soup(2'000, 1, 0.1f, 0.1f, {0, 1}, {3e5f, -1e6f, 2e5f}), 1.5e6f, 10'000,
                             "far away");
}

/// Neighboring triangles share vertices, some of which coincide when the shutter opens.
GeometryTables moving_cloth(std::uint32_t n, std::vector<float> times)
{
    Random random(n);
    GeometryTables tables = empty_tables();
    for (std::size_t key = 0; key < times.size(); ++key)
        for (std::uint32_t i = 0; i <= n; ++i)
            for (std::uint32_t j = 0; j <= n; ++j) {
                const bool folded = key == 0 && i % 7 == 0 && i > 0;
                const float x = float(folded ? i - 1 : i), y = float(j);
                tables.positions.push_back(
                    plus({x, y, std::sin(x + float(key)) * std::cos(y)}, key == 0 ? Vec3f{} : random.point(0.4f)));
            }
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            for (std::uint32_t v : {a, a + 1, b, b + 1, b, a + 1}) tables.triangles.push_back(v);
        }
    finish_moving(tables, (n + 1) * (n + 1), times);
    return tables;
}

TEST(Motion, shared_vertices)
{
    compare_with_brute_force(moving_cloth(3, {0, 1}), 5, 10'000, "a few");
    compare_with_brute_force(moving_cloth(40, {0, 1}), 40, 20'000, "cloth");
    compare_with_brute_force(moving_cloth(30, {0, 0.25f, 1}), 30, 10'000, "three keys");
}

/// Rays with times outside the shutter interval see the scene at its nearest end.
TEST(Motion, times_outside_the_shutter)
{
    compare_with_brute_force(moving_soup(500, 100, 10, 50, {0.25f, 0.5f}), 100, 10'000, "other times");
}

TEST(Motion, beside_what_stands_still)
{
    Random random(5);
    GeometryTables tables = moving_soup(800, 100, 10, 20, {0, 1});
    for (int i = 0; i < 800; ++i) {
        const Vec3f a = random.point(100);
        const Vec3f b = plus(a, random.point(10)), c = plus(a, random.point(10));
        add_triangle(tables, a, b, c);
        tables.quads.push_back({random.point(100), random.point(10), random.point(10)});
        tables.spheres.push_back({random.point(100), i & 1 ? random.point(30) : Vec3f{}, random.uniform(-8, 8)});
        tables.disks.push_back({random.point(100), random.direction(), random.uniform(0, 8)});
    }
    tables.shape_of_primitive.assign(800, 0);
    tables.shape_of_primitive.resize(1600, 1);
    tables.shapes.emplace_back();
    finish(tables);
    compare_with_brute_force(tables, 100, 20'000, "beside");
}

TEST(Motion, degenerate_and_not_finite)
{
    GeometryTables tables = moving_soup(300, 10, 3, 2, {0, 1});
    const std::size_t vertices = 900;
    // Triangles that are a point at the first key, a point at the last key, always a line, and never finite.
    for (std::size_t k = 0; k < 3; ++k) {
        tables.positions[k] = tables.positions[0];
        tables.positions[vertices + 3 + k] = tables.positions[vertices + 3];
        tables.positions[6 + k] = {float(k), 0, 0};
        tables.positions[vertices + 6 + k] = {float(k), 1, 0};
    }
    compare_with_brute_force(tables, 10, 20'000, "degenerate");
    Bvh bvh;
    tables.positions[vertices + 9].x = std::numeric_limits<float>::quiet_NaN();
    bvh.build(tables);
    EXPECT_EQ(bvh.statistics().leaf_primitives, 299u);
}

PoseRecord random_pose(Random& random, float time, double spread)
{
    PoseRecord pose = random_placement(random, time);
    const auto size = [&] { return float(10 * std::pow(spread, random.uniform(-1, 1))); };
    pose.stretch[0] = size(), pose.stretch[3] = size(), pose.stretch[5] = size();
    const float off = spread > 1 ? 0.2f * std::min({pose.stretch[0], pose.stretch[3], pose.stretch[5]}) : 0;
    pose.stretch[1] = random.uniform(-off, off), pose.stretch[4] = random.uniform(-off, off);
    return pose;
}

/// Shapes of each kind in moving and static instances.
GeometryTables moving_instances(std::size_t n, std::uint32_t poses, double spread, bool moving_mesh)
{
    Random random(n);
    GeometryTables tables = moving_mesh ? moving_soup(100, 1, 0.3f, 0.2f, {0, 0.5f, 1}) : soup(100, 1, 0.3f, 9);
    tables.world_triangles = 0;
    tables.shutter_open = 0, tables.shutter_close = 1;
    tables.shapes[0].flags = ShapeRecord::only_instanced;
    tables.shape_of_primitive.assign(100, 0);
    const auto add_shape = [&](int count) {
        tables.shape_of_primitive.resize(tables.shape_of_primitive.size() + std::size_t(count),
                                         std::uint32_t(tables.shapes.size()));
        tables.shapes.emplace_back().flags = ShapeRecord::only_instanced;
    };
    for (int i = 0; i < 5; ++i) tables.quads.push_back({random.point(1), random.point(1), random.point(1)});
    add_shape(5);
    for (int i = 0; i < 5; ++i)
        tables.spheres.push_back({random.point(1), random.point(i & 1 ? 0.f : 1.f), random.uniform(-0.3f, 0.3f)});
    add_shape(5);
    for (int i = 0; i < 5; ++i) tables.disks.push_back({random.point(1), random.direction(), random.uniform(0, 0.4f)});
    add_shape(5);
    tables.shapes[1].first_primitive = tables.first_quad();
    tables.shapes[2].first_primitive = tables.first_sphere();
    tables.shapes[3].first_primitive = tables.first_disk();
    for (std::size_t i = 0; i < n; ++i) {
        InstanceRecord instance;
        instance.mesh_shape = instance.shape = random.below(4);
        if (i % 4 == 0) {
            const Vec3f p = random.point(60), axis = random.direction();
            const Transform t = Transform::translate({p.x, p.y, p.z}) *
                                Transform::rotate({axis.x, axis.y, axis.z}, random.uniform(0, 6)) *
                                Transform::scale({10, -8, 3});
            instance.object_from_render = rounded(t.inverse());
        } else {
            instance.poses = std::uint32_t(tables.poses.size()) << 8 | poses;
            for (std::uint32_t k = 0; k < poses; ++k) {
                PoseRecord pose = random_pose(random, float(k) / float(poses - 1), spread);
                if (k > 0) {
                    PoseRecord& before = tables.poses.back();
                    double cosine = 0;
                    for (int c = 0; c < 4; ++c) cosine += double(pose.rotation[c]) * before.rotation[c];
                    if (cosine < 0)
                        for (float& q : pose.rotation) q = -q;
                    const double angle = std::acos(std::min(1.0, std::abs(cosine)));
                    before.turns = float(angle / 6.283185307179586);
                    before.inverse_sine = float(1 / std::sin(angle));
                }
                tables.poses.push_back(pose);
            }
        }
        tables.instances.push_back(instance);
    }
    finish(tables);
    return tables;
}

TEST(Motion, instances)
{
    compare_with_brute_force(moving_instances(1, 2, 1, false), 60, 5'000, "one that stands still");
    compare_with_brute_force(moving_instances(40, 2, 1, false), 60, 10'000, "rigid");
    compare_with_brute_force(moving_instances(40, 5, 1, false), 60, 10'000, "five poses");
    compare_with_brute_force(moving_instances(40, 2, 4, false), 60, 10'000, "stretched");
    compare_with_brute_force(moving_instances(40, 3, 2, true), 60, 10'000, "of a mesh that moves");
}

/// Bits don't depend on the instruction set: every build of this test has the same checksum.
TEST(Motion, the_same_bits_everywhere)
{
    std::uint64_t hash = 1469598103934665603u;
    const auto mix_in = [&](std::uint32_t x) { hash = (hash ^ x) * 1099511628211u; };
    for (const GeometryTables& tables :
         {moving_soup(2'000, 100, 10, 5, {0, 0.25f, 1}), moving_instances(100, 3, 2, true)}) {
        Bvh bvh;
        bvh.build(tables);
        Rays rays = difficult_rays(tables, 100, 10'000, 15);
        const Hits hits = cast(bvh, rays, true);
        for (std::size_t i = 0; i < rays.count(); ++i) {
            mix_in(std::bit_cast<std::uint32_t>(hits.t[i]));
            mix_in(hits.primitive[i]);
            if (hits.primitive[i] < tables.first_sphere()) mix_in(std::bit_cast<std::uint32_t>(hits.u[i]));
        }
    }
    EXPECT_EQ(hash, 8616732447230043037u);
}

/// Motion bounds contain the moving shapes and are tight: rays visit few additional nodes.
TEST(Motion, boxes_follow)
{
    const GeometryTables tables = moving_soup(20'000, 100, 1, 0, {0, 1});
    GeometryTables flying = tables;
    for (std::size_t i = 60'000; i < 120'000; ++i) flying.positions[i] = plus(flying.positions[i], {30, 20, -10});
    Bvh still, moving;
    still.build(tables);
    moving.build(flying);
    EXPECT_LT(moving.statistics().cost, 1.02 * still.statistics().cost);
}

}  // namespace
}  // namespace fathom
