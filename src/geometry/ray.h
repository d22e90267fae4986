#pragma once
#include "geometry/records.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// N rays: points o + t d, 0 < t < t_max. Directions are unit.
struct Ray {
    Vec3 o, d;
    Float t_max;
    Float time;
};

/// The nearest hit of each lane: the least of (t, primitive). Without a hit primitive is no_index and t the ray's
/// t_max.
struct Hit {
    Float t;
    UInt primitive;
    UInt instance;  ///< no_index where the primitive stands in the world itself
    Float u, v;     ///< barycentric weights of a triangle's second and third vertex; not set for other kinds
};

inline constexpr float infinity = std::numeric_limits<float>::infinity();

/// 1 / d for slab tests: components are kept from 0, so that no product is NaN.
inline Vec3 safe_inverse(Vec3 d)
{
    const auto inverse = [](Float x) { return Float(1) / (x + copysign(Float(1e-20f), x)); };
    return {inverse(d.x), inverse(d.y), inverse(d.z)};
}

/// Rays that leave a surface begin a little off it, or they would meet it again where rounding put them on its other
/// side. How far that may be is bounded coordinate by coordinate (as in Pharr, Jakob, Humphreys, "Physically Based
/// Rendering", 6.8, and Ize 2013, "Robust BVH Ray Traversal"), and only what lies along the normal counts: on a level
/// ground it matters neither how wide it is nor how far away.
///
/// n, p  unit geometric normal, and the point
/// way   what was added up to find the point, and what the intersection test adds up when a ray comes back: of each
///       coordinate the largest magnitude, with either sign
/// Units are 2^-24 of a coordinate: p and what was added to it are rounded some times each, here and by the next test.
inline Float rounding_along(const Vec3& n, const Vec3& p, const Vec3& way)
{
    return Float(0x1p-21f) * dot(abs(n), abs(p)) + Float(0x1p-22f) * dot(abs(n), abs(way));
}
/// What comes on top where the test shears coordinates (TriangleRay), which mixes them.
inline constexpr float rounding_of_shear = 0x1p-23f;

}  // namespace FATHOM_LANES
}  // namespace fathom
