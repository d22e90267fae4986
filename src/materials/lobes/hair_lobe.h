// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Longitudinal (M) and azimuthal (N) lobes of rough hair fibers, each a normalized density.
#include "math/elementary.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// exp(-x) I0(x) for x >= 0, where I0 is the modified Bessel function; relative error below 5e-7.
/// Abramowitz and Stegun 1964, "Handbook of Mathematical Functions", 9.8.1 and 9.8.2.
inline Float scaled_bessel_i0(Float x)
{
    constexpr float small[] = {0.0045813f, 0.0360768f, 0.2659732f, 1.2067492f, 3.0899424f, 3.5156229f, 1.0f};
    constexpr float large[] = {0.00392377f,  -0.01647633f, 0.02635537f, -0.02057706f, 0.00916281f,
                               -0.00157565f, 0.00225319f,  0.01328592f, 0.39894228f};
    const auto polynomial = [](const auto& of, Float t) {
        Float sum(of[0]);
        for (std::size_t k = 1; k < std::size(of); ++k) sum = fma(sum, t, Float(of[k]));
        return sum;
    };
    constexpr float middle = 3.75f;
    const Float below = min(x, Float(middle)), above = max(x, Float(middle)), t = below * Float(1 / middle);
    return select(x < Float(middle), polynomial(small, t * t) * exp(-below),
                  polynomial(large, Float(middle) / above) / sqrt(above));
}

/// Longitudinal lobe M of variance v, about the cone of the mirror direction. Conserves energy for all v: d'Eon,
/// Francois, Hill, Letteri, Aubry 2011, "An Energy-Conserving Hair Reflectance Model", 3.
struct HairLongitudinal {
    Float v, inverse_v, tail;  ///< tail: exp(-2 / v), the smallest value of the exponential

    HairLongitudinal() = default;
    explicit HairLongitudinal(Float variance) : v(variance), inverse_v(Float(1) / v), tail(exp(Float(-2) * inverse_v))
    {
    }
    /// Density over the sine of the incident angle; it integrates to 1. Angles theta are measured from the plane across
    /// the fiber.
    Float pdf(Float sin_i, Float cos_i, Float sin_o, Float cos_o) const
    {
        // The exponent is (cos(i + o) - 1) / v, written without cancellation.
        const Float c = cos_i - cos_o, s = sin_i + sin_o;
        const Float exponent = Float(-0.5f) * fma(c, c, s * s) * inverse_v;
        return scaled_bessel_i0(cos_i * cos_o * inverse_v) * exp(exponent) * inverse_v / (Float(1) - tail);
    }
    /// Samples the sine of the incident angle: d'Eon, Marschner, Hanika 2013, "Importance Sampling for Physically-Based
    /// Hair Fiber Models".
    Float sample(Float sin_o, Float cos_o, Sample2 u) const
    {
        const Float x = fma(Float(1) - u.x, tail, u.x);
        const Float below = max(v * log(max(x, Float(1e-30f))), Float(-2));  // cosine to the axis of the cone, minus 1
        const Float cosine = Float(1) + below, sine = sqrt(max(-below * (Float(2) + below), Float(0)));
        return clamp(fma(sine * sincos_2pi(u.y).cos, cos_o, -(cosine * sin_o)), Float(-1), Float(1));
    }
};

/// Azimuthal lobe N: a logistic distribution trimmed to [-pi, pi]. Chiang, Bitterli, Tappan, Burley 2016, "A Practical
/// and Controllable Hair and Fur Model for Production Path Tracing", 4.
struct HairAzimuthal {
    Float s, inverse_s, tail;

    HairAzimuthal() = default;
    explicit HairAzimuthal(Float scale) : s(scale), inverse_s(Float(1) / s), tail(exp(Float(-pi) * inverse_s)) {}

    /// Density over the azimuth. x: angle in radians from the direction of a smooth fiber, in any period.
    Float pdf(Float x) const
    {
        const Float turns = x * Float(0.5f * inv_pi);
        const Float off = (turns - floor(turns + Float(0.5f))) * Float(2 * pi);
        const Float e = exp(-abs(off) * inverse_s), sum = Float(1) + e;
        return e * inverse_s * (Float(1) + tail) / (sum * sum * (Float(1) - tail));
    }
    /// Samples the azimuth in [-pi, pi].
    Float sample(Float u) const
    {
        const Float part = u * (Float(1) - tail);
        const Float odds = max(tail + part, Float(1e-30f)) / max(Float(1) - part, Float(1e-30f));
        return clamp(s * log(odds), Float(-pi), Float(pi));
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
