// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Elementary functions of lanes, implemented here so that results depend neither on the version of a math library nor
/// on the number of lanes.
#include <numbers>

#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

inline constexpr float pi = std::numbers::pi_v<float>;
inline constexpr float inv_pi = std::numbers::inv_pi_v<float>;

/// Sine and cosine of one angle.
struct SinCos {
    Float sin, cos;
};

/// Sine and cosine of 2 pi x for |x| < 2^20; absolute error below 1.5e-7. x is reduced exactly to a quarter turn, so
/// large arguments lose no accuracy. The polynomials are minimax on [-1/8, 1/8].
inline SinCos sincos_2pi(Float x)
{
    const Float quarter = floor(fma(x, Float(4), Float(0.5f)));
    const Float r = fma(quarter, Float(-0.25f), x);
    const Float r2 = r * r;
    Float s = fma(r2, Float(41.47294918f), Float(-76.69786997f));
    s = fma(r2, s, Float(81.60520475f));
    s = fma(r2, s, Float(-41.34170215f));
    s = r * fma(r2, s, Float(6.28318531f));
    Float c = fma(r2, Float(59.42433142f), Float(-85.44882532f));
    c = fma(r2, c, Float(64.93936908f));
    c = fma(r2, c, Float(-19.73920879f));
    c = fma(r2, c, Float(1));
    const UInt q = to_uint(quarter);
    const Mask swap = (q & UInt(1)) != UInt(0);
    const Float a = select(swap, c, s), b = select(swap, s, c);
    return {bits_float(float_bits(a) ^ ((q & UInt(2)) << 30)),
            bits_float(float_bits(b) ^ (((q + UInt(1)) & UInt(2)) << 30))};
}

/// Angle of the point (x, y) in (-pi, pi]; absolute error below 4e-7. The angle of the origin is 0.
inline Float atan2(Float y, Float x)
{
    const Float ax = abs(x), ay = abs(y);
    const Float hi = max(ax, ay), lo = min(ax, ay);
    const Float a = select(hi > Float(0), lo / hi, Float(0));
    const Float s = a * a;
    // The polynomial approximates atan(a) / a on [0, 1], minimax in a^2.
    Float r = fma(s, Float(0.00297459f), Float(-0.01658117f));
    r = fma(s, r, Float(0.04355352f));
    r = fma(s, r, Float(-0.07580576f));
    r = fma(s, r, Float(0.10678939f));
    r = fma(s, r, Float(-0.14214209f));
    r = fma(s, r, Float(0.19994137f));
    r = fma(s, r, Float(-0.33333167f));
    r = fma(s * a, r, a);
    r = select(ay > ax, Float(pi / 2) - r, r);
    r = select(x < Float(0), Float(pi) - r, r);
    return copysign(r, y);
}

/// Arc cosine in [0, pi]; |x| slightly above 1 through rounding is accepted.
inline Float acos(Float x) { return atan2(sqrt(max(fma(-x, x, Float(1)), Float(0))), x); }

/// 2^x with relative error below 2e-7; 0 for x < -126, infinity for x >= 128.
inline Float exp2(Float x)
{
    const Float c = clamp(x, Float(-127), Float(128));
    const Float n = floor(c + Float(0.5f));
    const Float f = c - n;
    Float p = fma(f, Float(1.54762792e-4f), Float(1.34002353e-3f));
    p = fma(f, p, Float(9.61800398e-3f));
    p = fma(f, p, Float(5.55032791e-2f));
    p = fma(f, p, Float(2.40226513e-1f));
    p = fma(f, p, Float(6.93147206e-1f));
    p = fma(f, p, Float(1));
    const Float scaled = bits_float(float_bits(p) + (to_uint(n) << 23));
    return select(x < Float(-126), Float(0), select(x >= Float(128), bits_float(UInt(0x7f800000u)), scaled));
}
inline Float exp(Float x) { return exp2(x * Float(std::numbers::log2e_v<float>)); }

/// Logarithm to base 2 of a positive normal number. The error is below 3e-7: absolute near x = 1, relative elsewhere.
inline Float log2(Float x)
{
    const UInt bits = float_bits(x);
    const UInt e = (bits - UInt(0x3f3504f3u)) & UInt(0xff800000u);
    const Float m = bits_float(bits - e);  // in [sqrt(1/2), sqrt(2))
    const Float n = to_float(e) * Float(1.0f / (1 << 23));
    // log(m) = 2 atanh((m - 1) / (m + 1)), expanded as a polynomial in f^2.
    const Float f = (m - Float(1)) / (m + Float(1));
    const Float f2 = f * f;
    Float p = fma(f2, Float(0.34146843f), Float(0.41163071f));
    p = fma(f2, p, Float(0.57708428f));
    p = fma(f2, p, Float(0.96179667f));
    p = fma(f2 * f, p, f * Float(2.88539008f));
    return n + p;
}
inline Float log(Float x) { return log2(x) * Float(std::numbers::ln2_v<float>); }
/// x^y for x >= 0; 0 for x = 0.
inline Float pow(Float x, Float y) { return select(x > Float(0), exp2(y * log2(x)), Float(0)); }

}  // namespace FATHOM_LANES
}  // namespace fathom
