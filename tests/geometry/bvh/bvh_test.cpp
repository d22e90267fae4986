// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "compare_with_brute_force.h"
#include "geometry/bvh/builder/builder.h"

namespace fathom {
namespace {

TEST(Bvh, nothing)
{
    GeometryTables tables = empty_tables();
    finish(tables);
    compare_with_brute_force(tables, 1, 100, "nothing");
    Bvh never_built;
    Rays rays = difficult_rays(tables, 1, 100, 1);
    EXPECT_EQ(cast(never_built, rays, true).primitive[0], no_index);
}

TEST(Bvh, few_triangles)
{
    for (std::size_t n : {1, 2, 3, 15, 16, 17, 33, 100}) compare_with_brute_force(soup(n, 1, 1, n), 1, 20'000, "few");
}

TEST(Bvh, random_triangles)
{
    compare_with_brute_force(soup(3'000, 100, 10, 1), 100, 40'000, "soup");
    compare_with_brute_force(soup(3'000, 100, 200, 2), 100, 20'000, "large");
    compare_with_brute_force(soup(5'000, 1000, 0.5f, 3), 1000, 20'000, "small");
    compare_with_brute_force(soup(3'000, 1e-12f, 1e-13f, 4), 1e-12f, 20'000, "tiny");
    compare_with_brute_force(soup(3'000, 1e8f, 1e7f, 5), 1e8f, 20'000, "huge");
    compare_with_brute_force(soup(3'000, 1, 0.1f, 6, {3e5f, -1e6f, 2e5f}), 1.5e6f, 20'000, "far away");
}

TEST(Bvh, treelets_and_upper_tree)
{
    compare_with_brute_force(soup(100'000, 100, 2, 9), 100, 2'000, "100,000");
}

TEST(Bvh, needles)
{
    Random random(3);
    GeometryTables tables = empty_tables();
    for (int i = 0; i < 3'000; ++i) {
        const Vec3f a = random.point(100), b = plus(a, times(random.direction(), 80)),
                    c = plus(b, times(random.direction(), 1e-5f));
        add_triangle(tables, a, b, c);
    }
    finish(tables);
    compare_with_brute_force(tables, 100, 30'000, "needles");
}

TEST(Bvh, grids_piles_and_duplicates)
{
    GeometryTables tables = empty_tables();
    for (int copy = 0; copy < 40; ++copy)
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) {
                const Vec3f a{float(x), float(y), 0}, b{float(x + 1), float(y), 0}, c{float(x), float(y + 1), 0},
                    d{float(x + 1), float(y + 1), 0};
                add_triangle(tables, a, b, c);
                add_triangle(tables, d, c, b);
            }
    finish(tables);
    compare_with_brute_force(tables, 8, 20'000, "pile");
}

/// A height field of n x n squares, two triangles each. apart: whether each triangle has its own vertices, as with face
/// normals.
GeometryTables ground(std::uint32_t n, bool apart)
{
    Random random(24);
    GeometryTables tables = empty_tables();
    for (std::uint32_t i = 0; i <= n * (n + 2); ++i)
        tables.positions.push_back({float(i / (n + 1)), random.uniform(), float(i % (n + 1))});
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
            for (std::uint32_t v : {a, b, c, b, d, c}) tables.triangles.push_back(v);
        }
    if (apart) {
        const auto shared = tables.positions;
        tables.positions.clear();
        for (std::uint32_t& v : tables.triangles) {
            tables.positions.push_back(shared[v]);
            v = std::uint32_t(tables.positions.size() - 1);
        }
    }
    finish(tables);
    return tables;
}

/// Checks shadow rays that start near common points, with and without some long rays. centers: draws the common points.
template <class Centers>
void expect_short_rays(const GeometryTables& tables, BvhQuality level, const Centers& centers)
{
    Bvh bvh;
    bvh.build(tables, level);
    Random random(41);
    for (bool some_long : {false, true}) {
        Rays rays;
        for (int group = 0; group < 100; ++group) {
            const Vec3f center = centers(random);
            const float reach = group % 2 ? 5 : 20;  // rays within a quarter of the scene's size are traced as a packet
            for (int i = 0; i < 64; ++i) {
                const bool is_long = some_long && random.below(20) == 0;
                const Vec3f along = random.below(3)   ? random.direction()
                                    : random.below(2) ? Vec3f{0, 0, 1}
                                                      : Vec3f{-1, 0, 0};
                rays.add(plus(center, random.point(2)), along,
                         is_long ? std::numeric_limits<float>::infinity() : random.uniform(0, reach));
            }
        }
        const Hits expected = cast_brute_force(tables, rays);
        for (bool coherent : {false, true}) {
            const std::vector<std::uint32_t> blocked = cast_shadows(bvh, rays, coherent);
            std::size_t wrong = 0, hits = 0;
            for (std::size_t i = 0; i < rays.count(); ++i) {
                wrong += blocked[i] != (expected.primitive[i] != no_index);
                hits += blocked[i];
            }
            EXPECT_EQ(wrong, 0u);
            EXPECT_GT(hits, 100u);
        }
    }
}

/// Short rays with nearby origins are traversed as packets, unless some of them are long.
TEST(Bvh, short_rays)
{
    const GeometryTables hills = ground(60, false);
    for (BvhQuality level : {BvhQuality::standard, BvhQuality::compact}) {
        SCOPED_TRACE(int(level));
        expect_short_rays(soup(3'000, 100, 10, 1), level, [](Random& random) { return random.point(100); });
        const auto on_ground = [&](Random& random) {
            return hills.positions[random.below(std::uint32_t(hills.positions.size()))];
        };
        expect_short_rays(hills, level, on_ground);
    }
}

TEST(Bvh, degenerate_and_not_finite)
{
    GeometryTables tables = soup(500, 10, 3, 5);
    Random random(6);
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (int i = 0; i < 100; ++i) {
        const Vec3f a = random.point(10), b = random.point(10);
        add_triangle(tables, a, a, b);
        add_triangle(tables, a, b, b);
        add_triangle(tables, a, b, plus(times(a, 0.5f), times(b, 0.5f)));
        add_triangle(tables, a, a, a);
        add_triangle(tables, {nan, 0, 0}, a, b);
        add_triangle(tables, {inf, 0, 0}, a, {-inf, 1, 1});
    }
    finish(tables);
    Bvh bvh;
    bvh.build(tables);
    EXPECT_LT(bvh.statistics().leaf_primitives, tables.triangle_count());
    // The reference is brute force over the remaining, valid primitives.
    GeometryTables finite = tables;
    for (std::uint32_t& v : finite.triangles)
        if (!std::isfinite(finite.positions[v].x)) finite.triangles[&v - finite.triangles.data()] = 0;
    for (std::size_t i = 0; i < finite.triangles.size(); i += 3)
        if (finite.triangles[i] == 0 && i > 0) finite.triangles[i + 1] = finite.triangles[i + 2] = 0;
    Rays rays = difficult_rays(soup(500, 10, 3, 5), 10, 20'000, 8);
    expect_same(tables, cast(bvh, rays, true), cast_brute_force(finite, rays), rays.count(), "degenerate");
}

TEST(Bvh, exponential_sizes)
{
    // Each split separates one triangle, which gives the deepest possible tree.
    GeometryTables tables = empty_tables();
    for (int i = -60; i < 60; ++i) {
        const float s = std::ldexp(1.f, i);
        add_triangle(tables, {s, s, s}, {s, 2 * s, s}, {s, s, 2 * s});
    }
    finish(tables);
    compare_with_brute_force(tables, 100, 20'000, "exponential");
}

GeometryTables all_kinds(std::size_t n)
{
    Random random(11);
    GeometryTables tables = soup(n, 100, 10, 21);
    tables.shutter_open = 0;
    tables.shutter_close = 1;
    for (std::size_t i = 0; i < n; ++i) {
        tables.quads.push_back({random.point(100), random.point(10), random.point(10)});
        tables.spheres.push_back(
            {random.point(100), random.below(2) ? random.point(30) : Vec3f{}, random.uniform(-8, 8)});
        tables.disks.push_back({random.point(100), random.direction(), random.uniform(0, 8)});
    }
    tables.shape_of_primitive.clear();
    finish(tables);
    return tables;
}

TEST(Bvh, all_kinds)
{
    compare_with_brute_force(all_kinds(1), 100, 20'000, "one of each");
    compare_with_brute_force(all_kinds(500), 100, 30'000, "all kinds");
}

GeometryTables instances(std::size_t n, double spread)
{
    Random random(12);
    GeometryTables tables = soup(200, 50, 20, 31);
    tables.world_triangles = tables.triangle_count();
    for (std::uint32_t mesh = 1; mesh <= 3; ++mesh) {
        ShapeRecord shape;
        shape.first_primitive = tables.triangle_count();
        shape.flags = ShapeRecord::only_instanced;
        tables.shapes.push_back(shape);
        for (int i = 0; i < (mesh == 3 ? 0 : 150); ++i) {
            const Vec3f a = random.point(1);
            const Vec3f b = plus(a, random.point(0.3f)), c = plus(a, random.point(0.3f));
            add_triangle(tables, a, b, c);
        }
        tables.shape_of_primitive.resize(tables.triangle_count(), mesh);
    }
    for (std::uint32_t i = 0; i < 200; ++i) tables.shape_of_primitive[i] = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f p = random.point(60), axis = random.direction();
        const auto scale = [&] {
            const int sign = random.below(3) ? 1 : -1;
            return sign * 10 * std::pow(spread, random.uniform(-1, 1));
        };
        const float angle = random.uniform(0, 6);
        const Vec3d scales{scale(), scale(), scale()};
        const Transform t = Transform::translate({p.x, p.y, p.z}) * Transform::rotate({axis.x, axis.y, axis.z}, angle) *
                            Transform::scale(scales);
        InstanceRecord instance;
        instance.object_from_render = rounded(t.inverse());
        instance.mesh_shape = instance.shape = 1 + random.below(3);
        tables.instances.push_back(instance);
        if (i % 10 == 0) tables.instances.push_back(instance);
    }
    finish(tables);
    return tables;
}

TEST(Bvh, instances)
{
    compare_with_brute_force(instances(1, 1), 60, 10'000, "one");
    compare_with_brute_force(instances(100, 1), 60, 20'000, "rigid");
    compare_with_brute_force(instances(100, 5), 60, 20'000, "scaled and mirrored");
    compare_with_brute_force(instances(50, 100), 60, 10'000, "extremely scaled");
}

/// Movable instances have a top-level tree of their own.
TEST(Bvh, movable_instances)
{
    for (const std::uint32_t still : {0u, 1u, 50u, 110u}) {
        GeometryTables tables = instances(100, 5);
        tables.editable = true;
        tables.still_instances = std::min(still, std::uint32_t(tables.instances.size()));
        compare_with_brute_force(tables, 60, 10'000, "still");
    }
}

/// Memory of an instance with its share of the tree; materials are shared.
TEST(Bvh, bytes_of_an_instance)
{
    Random random(3);
    GeometryTables tables = soup(100, 1, 0.3f, 4);
    tables.world_triangles = 0;
    tables.shapes[0].flags = ShapeRecord::only_instanced;
    tables.shape_of_primitive.assign(100, 0);
    constexpr std::size_t n = 100'000;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f p = random.point(100);
        InstanceRecord instance;
        instance.object_from_render = rounded(Transform::translate({p.x, p.y, p.z}).inverse());
        tables.instances.push_back(instance);
    }
    Bvh bvh;
    bvh.build(tables);
    const double bytes = sizeof(InstanceRecord) + double(bvh.statistics().bytes) / double(n);
    EXPECT_LE(bytes, 128);
}

TEST(Bvh, alpha)
{
    GeometryTables tables = instances(50, 2);
    tables.shapes[0].flags |= ShapeRecord::alpha_tested, tables.shapes[1].flags |= ShapeRecord::alpha_tested;
    tables.quads.push_back({{-50, -50, 3}, {100, 0, 0}, {0, 100, 0}});
    finish(tables);
    struct Asked {
        static bool test(const void*, const AlphaCandidate& c)
        {
            const std::uint32_t ray = std::bit_cast<std::uint32_t>(c.origin[0]) + std::bit_cast<std::uint32_t>(c.t) +
                                      std::bit_cast<std::uint32_t>(c.direction[1]);
            return (c.primitive + c.instance + ray) % 3 != 0 && c.u + c.v < 0.9f;
        }
    };
    Bvh bvh;
    bvh.set_alpha_test(&Asked::test, nullptr);
    bvh.build(tables);
    // The reference restarts an opaque ray at each hit that the alpha test rejects.
    Bvh opaque;
    opaque.build(tables);
    Rays rays = difficult_rays(tables, 60, 10'000, 14);
    const Hits hits = cast(bvh, rays, false);
    expect_same(tables, cast(bvh, rays, true), hits, rays.count(), "alpha, coherent");
    const std::vector<std::uint32_t> blocked = cast_shadows(bvh, rays, false), together = cast_shadows(bvh, rays, true);
    std::size_t passed = 0;
    const Hits first = cast(opaque, rays, false);
    for (std::size_t i = 0; i < rays.count(); ++i) {
        EXPECT_EQ(blocked[i], hits.primitive[i] != no_index);
        EXPECT_EQ(together[i], blocked[i]);
        if (first.primitive[i] == no_index) continue;
        const std::uint32_t shape = first.instance[i] == no_index ? tables.shape_of_primitive[first.primitive[i]]
                                                                  : tables.instances[first.instance[i]].shape;
        const bool counts = shape > 1 || Asked::test(nullptr, {{rays.o[0][i], rays.o[1][i], rays.o[2][i]},
                                                               {rays.d[0][i], rays.d[1][i], rays.d[2][i]},
                                                               first.t[i],
                                                               first.u[i],
                                                               first.v[i],
                                                               first.primitive[i],
                                                               first.instance[i]});
        passed += !counts;
        if (counts)
            EXPECT_EQ(hits.primitive[i], first.primitive[i]);
        else
            EXPECT_GE(hits.t[i], first.t[i]);
    }
    EXPECT_GT(passed, 100u);
}

/// Bits don't depend on the instruction set: every build of this test has the same checksum.
TEST(Bvh, the_same_bits_everywhere)
{
    GeometryTables tables = all_kinds(2'000);
    Rays rays = difficult_rays(tables, 100, 20'000, 15);
    for (BvhQuality level : tree_builds) {
        Bvh bvh;
        bvh.build(tables, level);
        const Hits hits = cast(bvh, rays, true);
        EXPECT_EQ(hash_of(hits, rays.count(), tables.first_sphere(), tables.first_sphere()), 14386724077026236286u)
            << int(level);
    }
}

TEST(Bvh, the_same_tree_for_any_number_of_threads)
{
    // Some triangles are large, so that spatial splits divide them.
    GeometryTables tables = soup(200'000, 100, 1, 16);
    Random random(17);
    for (int i = 0; i < 2'000; ++i) add_triangle(tables, random.point(100), random.point(100), random.point(100));
    tables.shape_of_primitive.clear();
    finish(tables);
    for (BvhQuality level : tree_builds) {
        SCOPED_TRACE(int(level));
        const auto build = [&](std::size_t threads) {
            tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            BvhData data;
            bvh::BvhBuilder(tables, data, level).build();
            return data;
        };
        const BvhData one = build(1), many = build(4);
        ASSERT_EQ(one.nodes.size(), many.nodes.size());
        ASSERT_EQ(one.statistics.bytes, many.statistics.bytes);
        EXPECT_EQ(std::memcmp(one.nodes.data(), many.nodes.data(), one.nodes.size() * sizeof(BvhNode)), 0);
        ASSERT_EQ(one.others, many.others);
        const std::size_t bytes = one.statistics.bytes - one.nodes.size() * sizeof(BvhNode) - 4 * one.others.size();
        const std::size_t triangles = bytes / 40 - bvh_width;
        if (level != BvhQuality::compact) EXPECT_GE(triangles, tables.triangle_count());
        EXPECT_EQ(std::memcmp(one.triangles.data(), many.triangles.data(), 36 * triangles), 0);
        EXPECT_EQ(std::memcmp(one.keys.data(), many.keys.data(), 4 * triangles), 0);
    }
}

/// Cost, memory and traversal of the build levels, as far as they don't depend on the machine.
TEST(Bvh, levels_of_building)
{
    Random random(18);
    GeometryTables tables = soup(20'000, 100, 1, 19);
    for (int i = 0; i < 500; ++i) add_triangle(tables, random.point(100), random.point(100), random.point(100));
    tables.shape_of_primitive.clear();
    finish(tables);
    BvhStatistics of[std::size(tree_builds)];
    for (BvhQuality level : tree_builds) {
        Bvh bvh;
        bvh.build(tables, level);
        of[int(level)] = bvh.statistics();
        EXPECT_EQ(of[int(level)].leaf_primitives, tables.triangle_count());
        EXPECT_GE(of[int(level)].peak_bytes, of[int(level)].bytes);
    }
    EXPECT_LT(of[1].cost, of[0].cost);
    EXPECT_LT(of[2].cost, 0.97 * of[1].cost);
    EXPECT_LT(of[2].bytes, 1.4 * of[1].bytes);
    // The triangles share no vertices, so compact leaves save nothing.
    EXPECT_EQ(of[3].bytes, of[1].bytes);
    EXPECT_EQ(of[3].cost, of[1].cost);
}

TEST(Bvh, bytes_of_a_triangle)
{
    for (bool apart : {false, true}) {
        const GeometryTables tables = ground(200, apart);
        const double n = tables.triangle_count();
        Bvh plain, compact;
        plain.build(tables);
        compact.build(tables, BvhQuality::compact);
        EXPECT_EQ(compact.statistics().cost, plain.statistics().cost);
        EXPECT_EQ(compact.statistics().leaves, plain.statistics().leaves);
        EXPECT_LE(double(plain.statistics().bytes) / n, 50);
        EXPECT_LE(double(compact.statistics().bytes) / n, 35);
        EXPECT_LE(double(compact.statistics().peak_bytes) / n, 75);
    }
    // The triangles are slivers, half of which share an edge: compact leaves are never larger.
    GeometryTables slivers = empty_tables();
    Random random(25);
    for (int i = 0; i < 20'000; ++i) {
        const Vec3f a = random.point(100), b = plus(a, random.point(10)), c = plus(a, random.point(0.1f));
        add_triangle(slivers, a, b, c);
        if (i % 2) add_triangle(slivers, a, plus(b, random.point(0.1f)), c);
    }
    finish(slivers);
    Bvh plain, compact;
    plain.build(slivers);
    compact.build(slivers, BvhQuality::compact);
    EXPECT_LE(compact.statistics().bytes, plain.statistics().bytes);
    EXPECT_LE(compact.statistics().peak_bytes, plain.statistics().peak_bytes);
}

/// Leaves of both kinds with up to 16 triangles, side by side.
TEST(Bvh, compact_leaves)
{
    GeometryTables tables = ground(60, false);
    Random random(26);
    for (int i = 0; i < 1'000; ++i) {
        const Vec3f a = random.point(60);
        add_triangle(tables, a, plus(a, random.point(3)), plus(a, random.point(3)));
    }
    // A fan with more triangles than one leaf holds, over as many vertices as a leaf can hold.
    const Vec3f hub{10, 20, 10};
    for (int i = 0; i < 40; ++i) {
        const auto rim = [&](int k) {
            const float angle = float(k) * 0.15f;
            return plus(hub, {std::cos(angle), 0.01f * std::sin(3 * angle), std::sin(angle)});
        };
        add_triangle(tables, hub, rim(i), rim(i + 1));
    }
    tables.shape_of_primitive.clear();
    finish(tables);
    compare_with_brute_force(tables, 60, 20'000, "ground");
}

/// All triangles of a visited leaf are counted, and each visited node once per ray.
TEST(Bvh, visits)
{
    GeometryTables tables = soup(5, 1, 1, 20);
    Bvh few;
    few.build(tables);
    Rays rays = coherent_rays(tables, 1, 640, 21);
    const RayArrays arrays = rays.arrays();
    Hits hits(arrays.count);
    BvhVisits visits;
    few.closest(arrays, hits.arrays(), false, &visits);
    few.closest(arrays, hits.arrays(), true, &visits);
    // The root is a leaf with all triangles.
    EXPECT_EQ(visits.primitives, 2 * 5 * arrays.count);
    EXPECT_EQ(visits.nodes, 0u);
    tables = soup(2'000, 1, 0.1f, 22);
    Bvh many;
    many.build(tables);
    for (bool coherent : {false, true}) {
        visits = {};
        many.closest(arrays, hits.arrays(), coherent, &visits);
        // Rays that miss the scene visit only the root.
        EXPECT_GE(visits.nodes, arrays.count);
        EXPECT_LT(visits.nodes, 30 * arrays.count);
        EXPECT_GT(visits.primitives, 5 * arrays.count / 10);
    }
}

}  // namespace
}  // namespace fathom
