// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "math/elementary.h"
#include "math/vec3.h"
#include "sampling/sobol.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Direction about +z with density cos(theta) / pi with respect to solid angle.
inline Vec3 sample_cosine_hemisphere(Sample2 u)
{
    const Float r = sqrt(u.y);
    const SinCos phi = sincos_2pi(u.x);
    return {r * phi.cos, r * phi.sin, sqrt(Float(1) - u.y)};
}

/// Point of the unit disk, uniform by area. The concentric mapping (Shirley and Chiu 1997) preserves strata.
struct DiskPoint {
    Float x, y;
};
inline DiskPoint sample_disk(Sample2 u)
{
    const Float a = fma(u.x, Float(2), Float(-1)), b = fma(u.y, Float(2), Float(-1));
    const Mask first = abs(a) > abs(b);
    const Float r = select(first, a, b);
    const Float ratio = select(r != Float(0), select(first, b, a) / r, Float(0));
    // The angle in turns is ratio / 8 or 1/4 - ratio / 8.
    const SinCos phi = sincos_2pi(select(first, ratio * Float(0.125f), fma(ratio, Float(-0.125f), Float(0.25f))));
    return {r * phi.cos, r * phi.sin};
}

/// Direction about +z within a cone, uniform in solid angle: density 1 / (2 pi (1 - cos_max)). The argument is 1 -
/// cos_max because cos_max alone loses small cones to rounding.
inline Vec3 sample_cone(Sample2 u, Float one_minus_cos_max)
{
    const Float one_minus_cos = u.x * one_minus_cos_max;
    const Float sin_theta = sqrt(max(one_minus_cos * (Float(2) - one_minus_cos), Float(0)));
    const SinCos phi = sincos_2pi(u.y);
    return {sin_theta * phi.cos, sin_theta * phi.sin, Float(1) - one_minus_cos};
}

/// Direction, uniform over the sphere.
inline Vec3 sample_sphere(Sample2 u)
{
    return sample_cone(u, Float(2));
}

/// The point of a square for a direction (right, up, along), with coordinates from -1 to 1 to the right and up. Equal
/// solid angles have equal areas, and `along` is in the middle: Clarberg 2008, "Fast Equal-Area Mapping of the
/// (Hemi)Sphere using SIMD".
struct SquarePoint {
    Float x, y;
};
inline SquarePoint equal_area_square(Float right, Float up, Float along)
{
    // This is 1 - |along| without cancellation near the axis.
    const Float r = sqrt(fma(right, right, up * up) / (Float(1) + abs(along)));
    const Float turn = r * atan2(abs(up), abs(right)) * Float(2 * inv_pi);
    const Mask behind = along < Float(0);
    const Float u = select(behind, Float(1) - turn, r - turn), v = select(behind, Float(1) - (r - turn), turn);
    return {flip_sign(u, right), flip_sign(v, up)};
}

/// Weight of multiple importance sampling (MIS) by the power heuristic, for one sample of each of two strategies: Veach
/// 1997, eq. 9.13 with beta = 2. It is accurate for very large densities.
inline Float mis_weight(Float pdf, Float other)
{
    const Float r = other * reciprocal(pdf);
    return reciprocal(fma(r, r, Float(1)));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
