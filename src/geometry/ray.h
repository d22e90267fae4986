// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/records.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Rays, one per lane: points o + t d with 0 < t < t_max. Directions are unit vectors.
struct Ray {
    Vec3 o, d;
    Float t_max;
    Float time;
};

/// The nearest hit of each lane: the minimum of (t, primitive). Without a hit, primitive is no_index and t is t_max.
struct Hit {
    Float t;
    UInt primitive;
    UInt instance;  ///< no_index if the hit primitive is not instanced
    Float u, v;     ///< barycentric weights of a triangle's second and third vertex; not set for other primitives
};

inline constexpr float infinity = std::numeric_limits<float>::infinity();

/// 1 / d for slab tests; components are kept away from 0 so that no product is NaN.
inline Vec3 safe_inverse(Vec3 d)
{
    const auto inverse = [](Float x) { return Float(1) / (x + copysign(Float(1e-20f), x)); };
    return {inverse(d.x), inverse(d.y), inverse(d.z)};
}

/// Error bound for the offset of rays that leave a surface. Rays start slightly off the surface; otherwise they could
/// hit it again where rounding put them on its other side.
///
/// The error is bounded per coordinate (as in Pharr, Jakob, Humphreys, "Physically Based Rendering", 6.8, and Ize 2013,
/// "Robust BVH Ray Traversal"), and only its component along the normal counts. On a horizontal floor neither the size
/// of the floor nor the distance to it matters.
///
/// n, p: unit geometric normal, and the point. way: for each coordinate the largest magnitude, of either sign, of a
/// term of the sum that gave the point or of the sum in the next intersection test. Units are 2^-24 of a coordinate: p
/// and the terms are rounded a few times each, here and by the next test.
inline Float rounding_along(const Vec3& n, const Vec3& p, const Vec3& way)
{
    return Float(0x1p-21f) * dot(abs(n), abs(p)) + Float(0x1p-22f) * dot(abs(n), abs(way));
}
/// Additional error of the triangle test, whose shear mixes coordinates (TriangleRay).
inline constexpr float rounding_of_shear = 0x1p-23f;

}  // namespace FATHOM_LANES
}  // namespace fathom
