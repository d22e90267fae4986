// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Functions that compare BVH traversal with brute force.
#include <gtest/gtest.h>

#include "geometry/bvh/layout/data.h"
#include "rays_and_scenes.h"

namespace fathom {

inline constexpr BvhQuality tree_builds[] = {BvhQuality::fast, BvhQuality::standard, BvhQuality::high,
                                             BvhQuality::compact};

/// Rays from inside and outside: random, axis-aligned, at vertices, in planes of triangles, and short ones.
inline Rays difficult_rays(const GeometryTables& tables, float radius, std::size_t n, std::uint64_t seed)
{
    Random random(seed);
    Rays rays;
    const auto vertex = [&] {
        if (!tables.curve_points.empty() && (random.below(2) || tables.positions.empty())) {
            const Vec4f& p = tables.curve_points[random.below(std::uint32_t(tables.curve_points.size()))];
            return Vec3f{p.x, p.y, p.z};
        }
        return tables.positions.empty() ? Vec3f{}
                                        : tables.positions[random.below(std::uint32_t(tables.positions.size()))];
    };
    while (rays.count() < n) {
        const Vec3f o = random.point(radius * (random.below(4) ? 1.2f : 8.f));
        const float limit = random.below(3) ? std::numeric_limits<float>::infinity() : random.uniform(0, radius);
        // Each statement draws one number because the evaluation order of arguments depends on the compiler.
        const Vec3f anywhere = random.direction();
        rays.add(o, anywhere, limit, random.uniform());
        const float sign = random.below(2) ? 1.f : -1.f;
        const std::uint32_t axis = random.below(3);
        const Vec3f along{axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : -0.f};
        rays.add(o, along, limit, random.uniform());
        const Vec3f v = vertex();
        const Vec3f before = plus(v, times(along, -random.uniform(0, radius)));
        rays.add(before, along, limit, random.uniform());
        if (v.x != o.x || v.y != o.y || v.z != o.z) rays.add(o, unit_towards(o, v), limit, random.uniform());
        const Vec3f w = vertex();
        if (v.x != w.x || v.y != w.y || v.z != w.z) rays.add(v, unit_towards(v, w), limit, random.uniform());
    }
    return rays;
}

/// Coherent rays: groups of 64 with nearby origins and directions but different times.
inline Rays coherent_rays(const GeometryTables& tables, float radius, std::size_t n, std::uint64_t seed)
{
    Random random(seed);
    Rays rays;
    while (rays.count() < n) {
        const Vec3f o = random.point(3 * radius), at = random.point(0.7f * radius);
        const float width = radius * (random.below(2) ? 0.02f : 0.3f);
        const float limit = random.below(3) ? std::numeric_limits<float>::infinity() : random.uniform(0, 4 * radius);
        for (int i = 0; i < 64; ++i) {
            const Vec3f target = plus(at, random.point(width));
            rays.add(o, unit_towards(o, target), limit, random.uniform());
        }
    }
    return rays;
}

inline void expect_same(const GeometryTables& tables, const Hits& got, const Hits& expected, std::size_t n,
                        const char* what)
{
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < n; ++i) {
        bool same = got.t[i] == expected.t[i] && got.primitive[i] == expected.primitive[i] &&
                    got.instance[i] == expected.instance[i];
        // Only triangles and quads have u and v; curves have u.
        if (same && got.primitive[i] < tables.first_sphere())
            same = got.u[i] == expected.u[i] && got.v[i] == expected.v[i];
        if (same && got.primitive[i] >= tables.first_curve() && got.primitive[i] < tables.first_point())
            same = got.u[i] == expected.u[i];
        if (same) continue;
        if (++wrong > 5) continue;
        ADD_FAILURE() << what << ", ray " << i << ": t " << got.t[i] << ", primitive " << got.primitive[i]
                      << ", instance " << got.instance[i] << "; expected " << expected.t[i] << ", "
                      << expected.primitive[i] << ", " << expected.instance[i];
    }
    EXPECT_EQ(wrong, 0u) << what;
}

inline void compare_with_brute_force(const GeometryTables& tables, const Bvh& bvh, Rays rays, const char* what)
{
    const Hits expected = cast_brute_force(tables, rays);
    for (bool coherent : {false, true}) {
        expect_same(tables, cast(bvh, rays, coherent), expected, rays.count(), what);
        const std::vector<std::uint32_t> blocked = cast_shadows(bvh, rays, coherent);
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < rays.count(); ++i) wrong += blocked[i] != (expected.primitive[i] != no_index);
        EXPECT_EQ(wrong, 0u) << what << ", shadows";
    }
}

inline void compare_with_brute_force(const GeometryTables& tables, float radius, std::size_t n, const char* what)
{
    // The scalar build is slow, so it traces fewer rays.
    if (lanes == 1) n /= 10;
    for (BvhQuality level : tree_builds) {
        SCOPED_TRACE(int(level));
        Bvh bvh;
        bvh.build(tables, level);
        const std::size_t rays = level == BvhQuality::standard ? n : n / 4;
        compare_with_brute_force(tables, bvh, difficult_rays(tables, radius, rays, 7), what);
        compare_with_brute_force(tables, bvh, coherent_rays(tables, radius, rays / 4, 8), what);
    }
}

inline GeometryTables soup(std::size_t n, float radius, float size, std::uint64_t seed, Vec3f offset = {})
{
    Random random(seed);
    GeometryTables tables = empty_tables();
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f a = plus(random.point(radius), offset);
        const Vec3f b = plus(a, random.point(size)), c = plus(a, random.point(size));
        add_triangle(tables, a, b, c);
    }
    finish(tables);
    return tables;
}

inline std::array<float, 12> rounded(const Transform& t)
{
    std::array<float, 12> rows{};
    for (std::size_t i = 0; i < 12; ++i) rows[i] = float(t.m[i / 4][i % 4]);
    return rows;
}

}  // namespace fathom
