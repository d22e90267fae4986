#pragma once
#include "geometry/records.h"
#include "math/vec3.h"

namespace fathom::inline FATHOM_LANES {

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

/// A point moved off its surface along n (the unit geometric normal, on the side where the ray goes on), by more than
/// the rounding error of p: the error of a float position is a few 2^-24 of its largest coordinate.
inline Vec3 offset_origin(Vec3 p, Vec3 n, Float extent)
{
    return fma(n, Float(0x1p-19f) * max(max_abs(p), extent), p);
}

}  // namespace fathom::inline FATHOM_LANES
