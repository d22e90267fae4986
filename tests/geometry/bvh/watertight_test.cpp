// SPDX-License-Identifier: Apache-2.0
/// Tests that closed meshes are watertight: rays from inside that are aimed at edges and vertices always hit.
#include <gtest/gtest.h>

#include "compare_with_brute_force.h"

namespace fathom {
namespace {

/// A sphere with bumps: rings of vertices joined by triangles, closed at the poles.
GeometryTables closed_mesh(int rings, int sectors, float radius, float bumps, Vec3f center, Vec3f scale)
{
    Random random(5);
    GeometryTables tables = empty_tables();
    const auto add = [&](double theta, double phi) {
        const double r = radius * (1 + bumps * random.uniform(-1, 1));
        tables.positions.push_back({float(center.x + scale.x * r * std::sin(theta) * std::cos(phi)),
                                    float(center.y + scale.y * r * std::cos(theta)),
                                    float(center.z + scale.z * r * std::sin(theta) * std::sin(phi))});
    };
    add(0, 0);
    for (int i = 1; i < rings; ++i)
        for (int j = 0; j < sectors; ++j) add(M_PI * i / rings, 2 * M_PI * j / sectors);
    add(M_PI, 0);
    const auto at = [&](int i, int j) {
        return std::uint32_t(i == 0       ? 0
                             : i == rings ? int(tables.positions.size()) - 1
                                          : 1 + (i - 1) * sectors + j % sectors);
    };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j) {
            if (i > 0)
                for (std::uint32_t v : {at(i, j), at(i, j + 1), at(i + 1, j)}) tables.triangles.push_back(v);
            if (i + 1 < rings)
                for (std::uint32_t v : {at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)}) tables.triangles.push_back(v);
        }
    finish(tables);
    return tables;
}

void expect_no_misses(const GeometryTables& tables, BvhQuality level, Vec3f center, float inside, std::size_t n)
{
    Bvh bvh;
    bvh.build(tables, level);
    Random random(77);
    Rays rays;
    while (rays.count() < n) {
        const Vec3f o = plus(center, random.point(inside));
        const std::uint32_t triangle = random.below(tables.triangle_count()), corner = random.below(3);
        const Vec3f a = tables.positions[tables.triangles[3 * triangle + corner]];
        const Vec3f b = tables.positions[tables.triangles[3 * triangle + (corner + 1) % 3]];
        rays.add(o, unit_towards(o, a));
        const float s = random.uniform();
        rays.add(o, unit_towards(o, plus(times(a, 1 - s), times(b, s))));
        // Some rays are axis-aligned and pass exactly through a vertex.
        rays.add({a.x, a.y, center.z}, {0, 0, random.below(2) ? 1.f : -1.f});
        rays.add({center.x, a.y, a.z}, {random.below(2) ? 1.f : -1.f, 0, 0});
    }
    for (bool coherent : {false, true}) {
        const Hits hits = cast(bvh, rays, coherent);
        const std::vector<std::uint32_t> blocked = cast_shadows(bvh, rays, coherent);
        std::size_t missed = 0, passed = 0;
        for (std::size_t i = 0; i < rays.count(); ++i) {
            // An axis-aligned ray starts inside only if its vertex is not on the silhouette.
            if (i % 4 >= 2) {
                const float dx = rays.o[0][i] - center.x, dy = rays.o[1][i] - center.y, dz = rays.o[2][i] - center.z;
                if (dx * dx + dy * dy + dz * dz > inside * inside) continue;
            }
            missed += hits.primitive[i] == no_index;
            passed += blocked[i] == 0;
        }
        EXPECT_EQ(missed, 0u);
        EXPECT_EQ(passed, 0u);
    }
}

void expect_no_misses(const GeometryTables& tables, Vec3f center, float inside, std::size_t n)
{
    expect_no_misses(tables, BvhQuality::standard, center, inside, n);
    // Spatial splits of the triangles leave no cracks either.
    expect_no_misses(tables, BvhQuality::high, center, inside, n / 4);
    expect_no_misses(tables, BvhQuality::compact, center, inside, n / 4);
}

constexpr std::size_t many = lanes == 1 ? 50'000 : 1'000'000;

TEST(Watertight, bumpy_sphere)
{
    expect_no_misses(closed_mesh(60, 90, 100, 0.1f, {}, {1, 1, 1}), {}, 40, many);
}

TEST(Watertight, far_from_the_origin)
{
    const Vec3f center{20'000, -50'000, 70'000};
    expect_no_misses(closed_mesh(60, 90, 100, 0.1f, center, {1, 1, 1}), center, 40, many);
}

TEST(Watertight, large_and_fine)
{
    expect_no_misses(closed_mesh(300, 500, 1000, 0.001f, {}, {1, 1, 1}), {}, 400, many);
}

/// An axis-aligned box of many equal squares: edges and vertices lie exactly in planes of the tree's boxes.
TEST(Watertight, box_of_squares)
{
    GeometryTables tables = empty_tables();
    const int n = 24;
    const float size = 10;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const auto corner = [&](int u, int v) {
                        float p[3];
                        p[axis] = side ? size : -size;
                        p[(axis + 1) % 3] = -size + 2 * size * float(u) / float(n);
                        p[(axis + 2) % 3] = -size + 2 * size * float(v) / float(n);
                        return Vec3f{p[0], p[1], p[2]};
                    };
                    add_triangle(tables, corner(i, j), corner(i + 1, j), corner(i, j + 1));
                    add_triangle(tables, corner(i + 1, j + 1), corner(i, j + 1), corner(i + 1, j));
                }
    finish(tables);
    expect_no_misses(tables, {}, 9.5f, many);
}

TEST(Watertight, slivers)
{
    expect_no_misses(closed_mesh(4, 4000, 100, 0.f, {}, {1, 1, 1}), {}, 20, many);
}

TEST(Watertight, flattened)
{
    expect_no_misses(closed_mesh(60, 90, 100, 0.1f, {}, {1, 0.001f, 1}), {}, 0.03f, many);
}

}  // namespace
}  // namespace fathom
