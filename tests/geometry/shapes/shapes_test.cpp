// SPDX-License-Identifier: Apache-2.0
#include "geometry/shapes/shapes.h"

#include <gtest/gtest.h>

#include "geometry/bvh/plain.h"
#include "geometry/bvh/rays_and_scenes.h"

namespace fathom {
namespace {

float lane(Float a)
{
    float x[lanes];
    store(x, a);
    return x[0];
}
std::uint32_t lane(UInt a)
{
    std::uint32_t x[lanes];
    store(x, a);
    return x[0];
}
Ray ray_of(Vec3f o, Vec3f d, float t_max = std::numeric_limits<float>::infinity(), float time = 0)
{
    return {Vec3(o), Vec3(d), Float(t_max), Float(time)};
}
Hit no_hit(const Ray& ray)
{
    return {ray.t_max, UInt(no_index), UInt(no_index), Float(0), Float(0)};
}

/// Triangles agree with double precision. Only rays for which a slightly larger and a slightly smaller triangle agree
/// are tested.
TEST(Shapes, TrianglesInDouble)
{
    Random random(1);
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f a = random.point(3), b = random.point(3), c = random.point(3), o = random.point(5);
        const Vec3f d = unit_towards(o, random.point(2));
        const auto plain = [&](double grow) {
            return plain::intersect_triangle(plain::wide(a), plain::wide(b), plain::wide(c), plain::wide(o),
                                             plain::wide(d), grow);
        };
        const plain::Crossing expected = plain(0);
        if ((plain(1e-4).t < plain::nothing) != (plain(-1e-4).t < plain::nothing) || expected.t < 1e-3) continue;
        const Ray ray = ray_of(o, d);
        Hit hit = no_hit(ray);
        closest_triangle(TriangleRay(ray), Vec3(a), Vec3(b), Vec3(c), UInt(7u), hit);
        ASSERT_EQ(lane(hit.primitive), expected.t < plain::nothing ? 7 : no_index) << i;
        if (!(expected.t < plain::nothing)) continue;
        ++hits;
        ASSERT_NEAR(lane(hit.t) / expected.t, 1, 1e-3);
        ASSERT_NEAR(lane(hit.u), expected.u, 1e-3);
        ASSERT_NEAR(lane(hit.v), expected.v, 1e-3);
    }
    EXPECT_GT(hits, 1000);
}

/// The division-free test whether a triangle is hit before the ray's end agrees with the division: both windings, in
/// front of and behind the origin, any ray length.
TEST(Shapes, TrianglesStopRaysWithoutADivision)
{
    Random random(3);
    const float infinity = std::numeric_limits<float>::infinity();
    int before = 0, beyond = 0, behind = 0, of_either_turn[2] = {};
    for (int i = 0; i < 100000; ++i) {
        const Vec3f o = random.point(5);
        const Ray ray = ray_of(o, unit_towards(o, random.point(1)));
        const TriangleRay along(ray);
        const auto corner = [&] { return along.permute(Vec3(random.point(3)) - ray.o); };
        const Vec3 a = corner(), b = corner(), c = corner();
        const TriangleWeights w = triangle_weights(along.shear_x, along.shear_y, a, b, c);
        if (!(mask_bits(w.inside) & 1)) continue;
        const Vec3 z{a.z, b.z, c.z};
        const UndividedHits hits(w, along.shear_z, z);
        const auto stops = [&](float t_max) { return bool(mask_bits(hits.before(Float(t_max))) & 1); };
        Float t, u, v;
        const bool meets = mask_bits(triangle_distance(w, along.shear_z, z, Float(infinity), t, u, v)) & 1;
        ASSERT_EQ(stops(infinity), meets) << i;
        ASSERT_FALSE(stops(0)) << i;
        const float distance = lane(t);
        for (const float share : {0.01f, 0.5f, 0.99999f, 1.00001f, 2.0f, 100.0f}) {
            const float t_max = share * std::abs(distance);
            const bool expected = mask_bits(triangle_distance(w, along.shear_z, z, Float(t_max), t, u, v)) & 1;
            ASSERT_EQ(stops(t_max), expected) << i << " " << share;
            ++(expected ? before : meets ? beyond : behind);
        }
        ++of_either_turn[lane(hits.sum) < 0];
    }
    for (const int n : {before, beyond, behind, of_either_turn[0], of_either_turn[1]}) EXPECT_GT(n, 500);
}

/// Triangles that have no area as seen along the ray are never hit: the sum of their edge functions is 0.
TEST(Shapes, TrianglesWithoutAreaStopNoRay)
{
    const Ray ray = ray_of({0, 0, 0}, {0, 0, 1});
    const TriangleRay along(ray);
    const Vec3f triangles[][3] = {
        {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},             // the triangle is a point on the ray
        {{-1, -1, 1}, {1, 1, 1}, {1, 1, 1}},           // the triangle is a segment across the ray
        {{-1, 0, 1}, {1, 0, 1}, {0, 0, 1}},            // the triangle has three collinear vertices
        {{0, -1, 1}, {0, 1, 1}, {0, 0, 3}},            // the triangle is seen edge-on
        {{0, 0, -1}, {0, 0, 1}, {0, 0, 2}},            // the triangle is a segment along the ray
        {{-1e-30f, 0, 1}, {1e-30f, 0, 1}, {0, 0, 1}},  // the edge functions underflow
        {{-1e-30f, 0, 1}, {1e-30f, 0, 1}, {0, 1e-30f, 1}},
    };
    for (const auto& v : triangles) {
        const Vec3 a = along.permute(Vec3(v[0])), b = along.permute(Vec3(v[1])), c = along.permute(Vec3(v[2]));
        const TriangleWeights w = triangle_weights(along.shear_x, along.shear_y, a, b, c);
        const Vec3 z{a.z, b.z, c.z};
        const UndividedHits hits(w, along.shear_z, z);
        ASSERT_EQ(lane(hits.sum), 0) << v[0].x << " " << v[1].x << " " << v[2].z;
        for (const float t_max : {0.5f, 2.0f, 1e30f, std::numeric_limits<float>::infinity()}) {
            EXPECT_TRUE(none(hits.before(Float(t_max)))) << t_max;
            Float t, u, v2;
            EXPECT_TRUE(none(triangle_distance(w, along.shear_z, z, Float(t_max), t, u, v2))) << t_max;
        }
    }
}

/// On a shared edge or vertex the triangle with the lowest index is hit at the same place, in either order.
TEST(Shapes, SharedEdgesBelongToTheLowestNumber)
{
    const Vec3f corner[4] = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    const int triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    // Points on the diagonal are exact; rays run along z and from a corner.
    for (const float x : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f})
        for (const Vec3f& o : {Vec3f{x, x, 0}, {0, 0, 0}, {x, x, 3}})
            for (const bool swapped : {false, true}) {
                const Vec3f d = unit_towards(o, {x, x, 1});
                const Ray ray = ray_of(o, d);
                Hit hit = no_hit(ray);
                for (int k : {swapped ? 1 : 0, swapped ? 0 : 1}) {
                    const int* v = triangles[k];
                    closest_triangle(TriangleRay(ray), Vec3(corner[v[0]]), Vec3(corner[v[1]]), Vec3(corner[v[2]]),
                                     UInt(std::uint32_t(k + 5)), hit);
                }
                EXPECT_EQ(lane(hit.primitive), 5u) << x << " " << o.z << swapped;
            }
}

/// The nearest of two hits counts in either order, but nothing beyond the ray's end or behind its origin.
TEST(Shapes, TheNearestCounts)
{
    const auto triangle_at = [](float z) { return std::array{Vec3f{-1, -1, z}, Vec3f{2, -1, z}, Vec3f{-1, 2, z}}; };
    SphereRecord sphere;
    DiskRecord disk;
    disk.normal = {0, 0, -1};
    for (const float t_max : {0.5f, 1.5f, 2.5f, 9.0f})
        for (int kind = 0; kind < 3; ++kind)
            for (const bool swapped : {false, true}) {
                const Ray ray = ray_of({0, 0, 0}, {0, 0, 1}, t_max);
                Hit hit = no_hit(ray);
                for (int k : {swapped ? 1 : 0, swapped ? 0 : 1}) {
                    const float z = float(k + 1);
                    const std::uint32_t number = k == 0 ? 9 : 4;  // the nearer shape has the higher index
                    if (kind == 0) {
                        const auto v = triangle_at(z);
                        closest_triangle(TriangleRay(ray), Vec3(v[0]), Vec3(v[1]), Vec3(v[2]), UInt(number), hit);
                        const auto behind = triangle_at(-z);
                        closest_triangle(TriangleRay(ray), Vec3(behind[0]), Vec3(behind[1]), Vec3(behind[2]), UInt(1u),
                                         hit);
                    }
                    sphere.radius = 0.25f, sphere.center = {0, 0, z + 0.25f};
                    if (kind == 1) closest_sphere(sphere, number, ray, hit);
                    sphere.center = {0, 0, -z};
                    if (kind == 1) closest_sphere(sphere, 1, ray, hit);
                    disk.center = {0, 0, z};
                    if (kind == 2) closest_disk(disk, number, ray, hit);
                    disk.center = {0, 0, -z};
                    if (kind == 2) closest_disk(disk, 1, ray, hit);
                }
                EXPECT_EQ(lane(hit.primitive), t_max > 1 ? 9 : no_index) << kind << " " << t_max;
                EXPECT_FLOAT_EQ(lane(hit.t), t_max > 1 ? 1 : t_max);
            }
}

/// Among shapes at equal distance the one with the lowest index is hit, in either order.
TEST(Shapes, RoundOnesInTheSamePlace)
{
    SphereRecord sphere;
    sphere.center = {0, 0, 3};
    DiskRecord disk;
    disk.center = {0, 0, 3}, disk.normal = {0, 0, 1};
    const Ray ray = ray_of({0, 0, 0}, {0, 0, 1});
    for (const std::uint32_t first : {2u, 3u}) {
        Hit a = no_hit(ray), b = no_hit(ray);
        closest_sphere(sphere, first, ray, a), closest_sphere(sphere, 5 - first, ray, a);
        closest_disk(disk, first, ray, b), closest_disk(disk, 5 - first, ray, b);
        EXPECT_EQ(lane(a.primitive), 2u);
        EXPECT_EQ(lane(b.primitive), 2u);
    }
}

TEST(Shapes, SpheresAndDisksInDouble)
{
    Random random(2);
    int spheres = 0, disks = 0, inside = 0;
    for (int i = 0; i < 20000; ++i) {
        SphereRecord sphere;
        sphere.center = random.point(3), sphere.motion = random.point(2);
        sphere.radius = random.uniform(0.1f, 2) * (random.below(2) ? 1.f : -1.f);
        DiskRecord disk{random.point(2), random.direction(), random.uniform(0.2f, 2)};
        const Vec3f o = random.point(4), d = unit_towards(o, random.point(2));
        const float time = random.uniform();
        const Vec3d center = plain::wide(sphere.center) + plain::wide(sphere.motion) * double(time);
        const Ray ray = ray_of(o, d, std::numeric_limits<float>::infinity(), time);
        const auto check = [&](auto plain, const Hit& hit, int& count) {
            const double expected = plain(0.0);
            if ((plain(1e-4) < plain::nothing) != (plain(-1e-4) < plain::nothing) || expected < 1e-2) return;
            ASSERT_EQ(lane(hit.primitive), expected < plain::nothing ? 3 : no_index) << i;
            if (!(expected < plain::nothing)) return;
            ++count;
            ASSERT_NEAR(lane(hit.t), expected, 2e-3);
        };
        Hit a = no_hit(ray), b = no_hit(ray);
        closest_sphere(sphere, 3, ray, a);
        closest_disk(disk, 3, ray, b);
        const double radius = std::abs(double(sphere.radius));
        inside += length(plain::wide(o) - center) < radius;
        check(
            [&](double grow) { return plain::intersect_sphere(center, radius, plain::wide(o), plain::wide(d), grow); },
            a, spheres);
        check(
            [&](double grow) {
                return plain::intersect_disk(plain::wide(disk.center), plain::wide(disk.normal), disk.radius,
                                             plain::wide(o), plain::wide(d), grow);
            },
            b, disks);
    }
    EXPECT_GT(spheres, 1000);
    EXPECT_GT(disks, 1000);
    EXPECT_GT(inside, 100);
}

/// A small distant sphere is hit with an error of at most a hundredth of its radius.
TEST(Shapes, AFarSmallSphere)
{
    SphereRecord sphere;
    sphere.center = {600, 800, 0}, sphere.radius = 0.1f;
    for (const float aside : {0.0f, 0.05f, 0.09f, 0.11f}) {
        const Ray ray = ray_of({-0.8f * aside, 0.6f * aside, 0}, {0.6f, 0.8f, 0});
        Hit hit = no_hit(ray);
        closest_sphere(sphere, 0, ray, hit);
        EXPECT_EQ(lane(hit.primitive), aside < 0.1f ? 0 : no_index) << aside;
        if (aside < 0.1f) EXPECT_NEAR(lane(hit.t), 1000 - std::sqrt(0.01 - double(aside) * double(aside)), 1e-3);
    }
}

/// The bound exceeds the rounding error but not by much, and only displacement along the normal counts.
TEST(Shapes, RoundingAlongTheNormal)
{
    for (const float size : {1e-3f, 1.f, 1000.f}) {
        const Vec3 p(Vec3f{size, 0.5f * size, 0.25f * size}), n(Vec3f{0, 0, -1});
        const auto bound = [&](Vec3f way) { return lane(rounding_along(n, p, Vec3(way))); };
        const float still = bound({0, 0, 0});
        EXPECT_GT(still, 0.25f * size * 0x1p-23f);
        EXPECT_LT(still, size * 0x1p-20f);
        EXPECT_EQ(bound({64 * size, -64 * size, 0}), still);
        EXPECT_GT(bound({0, 0, 64 * size}), 32 * still);
        EXPECT_EQ(bound({0, 0, 64 * size}), bound({0, 0, -64 * size}));
    }
}

}  // namespace
}  // namespace fathom
