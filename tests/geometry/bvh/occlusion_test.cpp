// SPDX-License-Identifier: Apache-2.0
/// Tests of Bvh::expect, which orders children for shadow rays by the expected chance of occlusion.
#include <gtest/gtest.h>

#include "compare_with_brute_force.h"

namespace fathom {
namespace {

void add_box(GeometryTables& tables, Vec3f low, Vec3f high)
{
    const auto corner = [&](int i) {
        return Vec3f{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
    };
    constexpr int sides[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    for (const int(&s)[4] : sides) {
        add_triangle(tables, corner(s[0]), corner(s[1]), corner(s[2]));
        add_triangle(tables, corner(s[0]), corner(s[2]), corner(s[3]));
    }
}

/// A room of 20 x 20 x 4 with a screen of panels across its middle and small objects everywhere.
GeometryTables furnished_room()
{
    Random random(31);
    GeometryTables tables = empty_tables();
    add_box(tables, {-10, 0, -10}, {10, 4, 10});
    for (int i = -9; i < 9; ++i) add_box(tables, {float(i), 0.1f, -0.05f}, {float(i) + 0.9f, 3.5f, 0.05f});
    for (int i = 0; i < 600; ++i) {
        const Vec3f at{random.uniform(-9, 9), random.uniform(0.1f, 3.5f), random.uniform(-9, 9)};
        add_box(tables, at, plus(at, {0.1f, 0.1f, 0.1f}));
    }
    finish(tables);
    return tables;
}

/// Rays between the two halves of the room.
Rays rays_across(std::size_t n, std::uint64_t seed)
{
    Random random(seed);
    Rays rays;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f from{random.uniform(-9, 9), random.uniform(0.2f, 3.8f), random.uniform(-9, -1)};
        const Vec3f to{random.uniform(-9, 9), random.uniform(0.2f, 3.8f), random.uniform(1, 9)};
        const Vec3f between = plus(to, times(from, -1));
        rays.add(from, unit_towards(from, to),
                 std::sqrt(between.x * between.x + between.y * between.y + between.z * between.z));
    }
    return rays;
}

BvhVisits visits_of(const Bvh& bvh, Rays& rays)
{
    const RayArrays arrays = rays.arrays();
    std::vector<std::uint32_t> blocked(arrays.count);
    BvhVisits visits;
    bvh.occluded(arrays, blocked.data(), false, &visits);
    return visits;
}

TEST(BvhExpect, shadow_rays_meet_less)
{
    const GeometryTables tables = furnished_room();
    Bvh bvh;
    bvh.build(tables);
    Rays rays = rays_across(20'000, 32), others = rays_across(2'000, 33);
    const BvhVisits before = visits_of(bvh, rays);
    bvh.expect(others.arrays());
    const BvhVisits after = visits_of(bvh, rays);
    EXPECT_LT(double(after.primitives), 0.75 * double(before.primitives));
    EXPECT_LT(double(after.nodes), 1.05 * double(before.nodes));
}

/// Closest-hit rays still visit the nearest child first, so their visits are unchanged.
TEST(BvhExpect, changes_no_result)
{
    for (const GeometryTables& tables : {furnished_room(), soup(3'000, 10, 2, 34)}) {
        Bvh before, after;
        before.build(tables);
        after.build(tables);
        Rays some = rays_across(500, 35);
        after.expect(some.arrays());
        Rays rays = difficult_rays(tables, 10, 20'000, 36);
        for (bool coherent : {false, true}) {
            const Hits a = cast(before, rays, coherent), b = cast(after, rays, coherent);
            EXPECT_EQ(a.t, b.t);
            EXPECT_EQ(a.primitive, b.primitive);
            EXPECT_EQ(cast_shadows(before, rays, coherent), cast_shadows(after, rays, coherent));
        }
        // Closest-hit rays still visit the nearest child first.
        const RayArrays arrays = rays.arrays();
        Hits hits(arrays.count);
        BvhVisits was, is;
        before.closest(arrays, hits.arrays(), false, &was);
        after.closest(arrays, hits.arrays(), false, &is);
        EXPECT_EQ(was.nodes, is.nodes);
        EXPECT_EQ(was.primitives, is.primitives);
    }
}

/// Expected rays may be axis-parallel or have zero components, and trees may have one leaf or none.
TEST(BvhExpect, bears_anything)
{
    Rays rays = rays_across(10, 37);
    for (const Vec3f& d : {Vec3f{1, 0, 0}, Vec3f{0, -1, 0}, Vec3f{0, -0.f, 1}}) rays.add({0, 0, 0}, d);
    Bvh never_built;
    never_built.expect(rays.arrays());
    for (std::size_t n : {0, 1, 40}) {
        GeometryTables tables = empty_tables();
        if (n > 0) tables = soup(n, 10, 5, 38);
        finish(tables);
        Bvh bvh;
        bvh.build(tables);
        bvh.expect(rays.arrays());
        bvh.expect({});
    }
}

}  // namespace
}  // namespace fathom
