#pragma once
/// One ray with the triangles of a leaf.
#include "geometry/bvh/traverse/ray.h"

namespace fathom::inline FATHOM_LANES {

/// What is known of the triangles before it is known where the ray meets them.
struct WeighedTriangles {
    alignas(64) float a[lanes], b[lanes], c[lanes];  ///< weights
    alignas(64) float z[3][lanes];                   ///< of the corners, along the ray's longest axis
    std::uint32_t inside;                            ///< those that the ray's line passes through

    TriangleWeights weights() const { return {load(a), load(b), load(c), mask_from_bits(inside)}; }
    Vec3 corners_z() const { return load_vec3(z[0], z[1], z[2]); }
};

/// The boxes of a leaf's n triangles, a lane each.
[[gnu::always_inline]] inline void triangle_boxes(const float* data, std::ptrdiff_t n, Float low[3], Float high[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const float* const p = data + axis * n;
        const Float a = load(p), b = load(p + 3 * n), c = load(p + 6 * n);
        low[axis] = min(min(a, b), c), high[axis] = max(max(a, b), c);
    }
}

/// F: Float, or half of one.
template <class F>
[[gnu::always_inline]] inline F load_as(const float* p)
{
    if constexpr (std::is_same_v<F, Float>)
        return load(p);
    else
        return native::load(p);
}

/// F: Float, or half of one for so few triangles.
template <class F>
[[gnu::always_inline]] inline void weigh_triangles(const float* data, std::ptrdiff_t n, const PreparedRay& r,
                                                   WeighedTriangles& out)
{
    const std::uint32_t axis = r.integer(PreparedRays::axis);
    const std::ptrdiff_t ix = axis == 2 ? 0 : axis + 1, iy = axis == 0 ? 2 : axis - 1, iz = axis;
    const F ox(r.number(PreparedRays::origin_x + int(ix))), oy(r.number(PreparedRays::origin_x + int(iy))),
        oz(r.number(PreparedRays::origin_x + int(iz)));
    const auto corner = [&](std::ptrdiff_t k) {
        const float* const p = data + 3 * k * n;
        return TriangleCorner<F>{load_as<F>(p + ix * n) - ox, load_as<F>(p + iy * n) - oy, load_as<F>(p + iz * n) - oz};
    };
    const TriangleCorner<F> a = corner(0), b = corner(1), c = corner(2);
    const TriangleWeightsOf<F> w =
        triangle_weights(F(r.number(PreparedRays::shear_x)), F(r.number(PreparedRays::shear_y)), a, b, c);
    store(out.a, w.a), store(out.b, w.b), store(out.c, w.c);
    store(out.z[0], a.z), store(out.z[1], b.z), store(out.z[2], c.z);
    out.inside = mask_bits(w.inside);
}

/// The ray with n triangles from `at` on, as many as there are lanes at most.
[[gnu::always_inline]] inline void weigh_triangles(const BvhData& bvh, std::uint32_t leaf, int at, const PreparedRay& r,
                                                   WeighedTriangles& out)
{
    const std::ptrdiff_t n = BvhReference::triangle_count(leaf);
    const float* const data = &bvh.triangles[9 * std::size_t(BvhReference::first_triangle(leaf))] + at;
    if (FATHOM_LANE_PAIRS && n <= native::lanes)
        weigh_triangles<native::Float>(data, n, r, out);
    else
        weigh_triangles<Float>(data, n, r, out);
    out.inside &= (std::uint32_t(2) << (n - at - 1)) - 1;
}

}  // namespace fathom::inline FATHOM_LANES
