#pragma once
/// Lanes: Float, UInt and Mask are N floats, 32-bit integers and booleans, N = `lanes` decided by the instruction set that
/// the file is compiled for: 16 (AVX-512), 8 (AVX2) or 1 (plain types, runs anywhere).
///
/// Every operation gives the same bits at each width. Arithmetic takes no mask: idle lanes compute garbage that nobody
/// reads. There are no estimates (rcp, rsqrt) and no sums across lanes. min(a, b) is a < b ? a : b and max(a, b) is
/// a > b ? a : b, NaN included. UInt arithmetic wraps; its comparisons and conversions are signed, so compared values stay
/// below 2^31. Intrinsics live in lanes_*.h and nowhere else, but in leaf functions of the BVH.
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__) && defined(__AVX512BW__)
#include "math/lanes_avx512.h"
#elif defined(__AVX2__) && defined(__FMA__)
#include "math/lanes_avx2.h"
#else
#include "math/lanes_scalar.h"
#endif

namespace fathom {


inline Float abs(Float a) { return bits_float(float_bits(a) & UInt(0x7fffffffu)); }
/// Magnitude of a, sign of b.
inline Float copysign(Float a, Float b)
{
    return bits_float((float_bits(a) & UInt(0x7fffffffu)) | (float_bits(b) & UInt(0x80000000u)));
}
/// a with its sign flipped where b is negative (or -0).
inline Float flip_sign(Float a, Float b) { return bits_float(float_bits(a) ^ (float_bits(b) & UInt(0x80000000u))); }
inline Float clamp(Float a, Float lo, Float hi) { return min(max(a, lo), hi); }
inline bool all(Mask m) { return none(!m); }
inline int count(Mask m) { return std::popcount(mask_bits(m)); }

/// Calls f(lane) for each lane of the mask, in ascending order.
template <class F>
void for_each_active(Mask m, F&& f)
{
    for (std::uint32_t bits = mask_bits(m); bits; bits &= bits - 1) f(std::countr_zero(bits));
}

}  // namespace fathom
