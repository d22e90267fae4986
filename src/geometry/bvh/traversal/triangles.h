// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Intersection of one ray with the triangles of a leaf: lanes are triangles.
#include "geometry/bvh/traversal/ray.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Result of the inside test, before distances are computed.
struct TriangleIntersections {
    TriangleWeights weights;  ///< inside: the ray's line passes through the triangle
    Vec3 corners_z;           ///< z of the three vertices, along the ray's longest axis
};

/// Converts half a Float, which suffices for few triangles, to a Float.
[[gnu::always_inline]] inline Float widened(native::Float x)
{
#if FATHOM_LANE_PAIRS
    return {x, x};
#else
    return x;
#endif
}
#if FATHOM_LANE_PAIRS
[[gnu::always_inline]] inline Float widened(Float x)
{
    return x;
}
#endif

/// Keeps the first n triangles, at most one per lane.
template <class F>
[[gnu::always_inline]] inline TriangleIntersections first_triangles(const TriangleWeightsOf<F>& w, F za, F zb, F zc,
                                                                    std::ptrdiff_t n)
{
    const std::uint32_t inside = mask_bits(w.inside) & ((std::uint32_t(2) << (n - 1)) - 1);
    return {{widened(w.a), widened(w.b), widened(w.c), mask_from_bits(inside)},
            {widened(za), widened(zb), widened(zc)}};
}

/// Bounding boxes of a leaf's n triangles, one per lane.
[[gnu::always_inline]] inline void triangle_boxes(const float* data, std::ptrdiff_t n, Float low[3], Float high[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const float* const p = data + axis * n;
        const Float a = load(p), b = load(p + 3 * n), c = load(p + 6 * n);
        low[axis] = min(min(a, b), c), high[axis] = max(max(a, b), c);
    }
}

/// Loads an F: Float, or half of one.
template <class F>
[[gnu::always_inline]] inline F load_as(const float* p)
{
    if constexpr (std::is_same_v<F, Float>)
        return load(p);
    else
        return native::load(p);
}

/// Intersects a ray with n triangles from index `at` on. F: Float, or half of one if that suffices.
template <class F>
[[gnu::always_inline]] inline TriangleIntersections intersect_triangles(const float* data, std::ptrdiff_t n,
                                                                        std::ptrdiff_t at, const PreparedRay& r)
{
    const std::ptrdiff_t ix = r.integer(PreparedRays::row_x), iy = r.integer(PreparedRays::row_y),
                         iz = r.integer(PreparedRays::axis);
    const F ox(r.number(PreparedRays::seen_x)), oy(r.number(PreparedRays::seen_y)), oz(r.number(PreparedRays::seen_z));
    const auto corner = [&](std::ptrdiff_t k) {
        const float* const p = data + 3 * k * n + at;
        return TriangleCorner<F>{load_as<F>(p + ix * n) - ox, load_as<F>(p + iy * n) - oy, load_as<F>(p + iz * n) - oz};
    };
    const TriangleCorner<F> a = corner(0), b = corner(1), c = corner(2);
    const TriangleWeightsOf<F> w =
        triangle_weights(F(r.number(PreparedRays::shear_x)), F(r.number(PreparedRays::shear_y)), a, b, c);
    return first_triangles(w, a.z, b.z, c.z, n - at);
}

/// Intersects a ray with a leaf's triangles from index `at` on, at most one per lane.
[[gnu::always_inline]] inline TriangleIntersections intersect_triangles(const BvhData& bvh, std::uint32_t leaf, int at,
                                                                        const PreparedRay& r)
{
    const std::ptrdiff_t n = BvhReference::triangle_count(leaf);
    const float* const data = &bvh.triangles[9 * std::size_t(BvhReference::first_triangle(leaf))];
    if (FATHOM_LANE_PAIRS && n <= native::lanes) return intersect_triangles<native::Float>(data, n, at, r);
    return intersect_triangles<Float>(data, n, at, r);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
