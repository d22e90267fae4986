#pragma once
/// Lanes: Float, UInt and Mask are N floats, 32-bit integers and booleans, N = `lanes` decided by the instruction set
/// that the file is compiled for: 16 (AVX-512), 8 (AVX2) or 1 (plain types, runs anywhere).
///
/// Every operation gives the same bits at each width. Arithmetic takes no mask: idle lanes compute garbage that nobody
/// reads. There are no estimates (rcp, rsqrt) and no sums across lanes. min(a, b) is a < b ? a : b and max(a, b) is
/// a > b ? a : b, NaN included. UInt arithmetic wraps; its comparisons and conversions are signed, so compared values
/// stay below 2^31. Intrinsics live in lanes_*.h and nowhere else, but in leaf functions of the BVH.
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

/// FATHOM_ONE_LANE: one lane whatever the instruction set, for a file that is called for one thing at a time.
#if FATHOM_ONE_LANE
#undef FATHOM_LANE_PAIRS
#define FATHOM_LANE_PAIRS 0
#include "math/lanes_scalar.h"
#elif defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512VL__) && defined(__AVX512BW__)
#include "math/lanes_avx512.h"
#elif defined(__AVX2__) && defined(__FMA__)
#include "math/lanes_avx2.h"
#else
#include "math/lanes_scalar.h"
#endif

/// Everything that is made of lanes lives in this inline namespace: two files of one library may use lanes of different
/// number, and the linker must not take the code of one for the other.
#if FATHOM_ONE_LANE
#define FATHOM_LANES one_lane
#elif FATHOM_LANE_PAIRS
#define FATHOM_LANES lanes_in_pairs
#else
#define FATHOM_LANES lanes_single
#endif

#if FATHOM_LANE_PAIRS
#include "math/lanes_pair.h"
#else
// By name, since an argument of type float (the base build) finds no namespace by itself.
namespace fathom {
inline namespace FATHOM_LANES {
using native::any;
using native::bits_float;
using native::compress_store;
using native::first_lanes;
using native::Float;
using native::float_bits;
using native::floor;
using native::fma;
using native::gather;
using native::gather_row;
using native::iota;
using native::lanes;
using native::lanes_name;
using native::least;
using native::less;
using native::load;
using native::lookup;
using native::Mask;
using native::mask_bits;
using native::mask_from_bits;
using native::max;
using native::min;
using native::min_each;
using native::none;
using native::reverse_bits;
using native::rotate16;
using native::select;
using native::sqrt;
using native::store;
using native::to_float;
using native::to_uint;
using native::UInt;
}  // namespace FATHOM_LANES
}  // namespace fathom
#endif

namespace fathom {
inline namespace FATHOM_LANES {

/// The most entries of a table that lookup() reads from registers; so many must be readable from the table's start on.
inline constexpr int lookup_size = 32;

/// Entries of a table with padding for lookup(), whatever its size; every index must be one of the table's `n`.
inline UInt lookup_or_gather(const std::uint32_t* table, int n, UInt index)
{
    return n <= lookup_size ? lookup(table, n, index) : gather(table, index);
}
/// For the lanes of m, whose indices alone must be the table's; 0 in others.
inline UInt lookup_or_gather(const std::uint32_t* table, int n, UInt index, Mask m)
{
    return n <= lookup_size ? select(m, lookup(table, n, index), UInt(0u)) : gather(table, index, m);
}

inline Float abs(Float a) { return bits_float(float_bits(a) & UInt(0x7fffffffu)); }
/// Magnitude of a, sign of b.
inline Float copysign(Float a, Float b)
{
    return bits_float((float_bits(a) & UInt(0x7fffffffu)) | (float_bits(b) & UInt(0x80000000u)));
}
/// a with its sign flipped where b is negative (or -0).
inline Float flip_sign(Float a, Float b) { return bits_float(float_bits(a) ^ (float_bits(b) & UInt(0x80000000u))); }
inline Float clamp(Float a, Float lo, Float hi) { return min(max(a, lo), hi); }
inline Mask equal(Mask a, Mask b) { return (a & b) | !(a | b); }
inline bool all(Mask m) { return none(!m); }
inline int count(Mask m) { return std::popcount(mask_bits(m)); }

/// 1 / a to within 2 ulp, for normal a > 0 whose inverse is normal; by multiplications, several of which run at once
/// where a division blocks. The guess is arithmetic, not the processor's estimate, which differs between makers.
inline Float reciprocal(Float a)
{
    // The exponent is mirrored, which leaves an error below 12 %; each step cubes it.
    Float y = bits_float(UInt(0x7ef311c7u) - float_bits(a));
    for (int i = 0; i < 2; ++i) {
        const Float e = fma(-a, y, Float(1));
        y = fma(y, fma(e, e, e), y);
    }
    return y;
}

/// 1 / sqrt(a) to within 2 ulp for normal a > 0; finite and large for 0, so that a * inverse_sqrt(a) is 0 there.
inline Float inverse_sqrt(Float a)
{
    // The guess is off by 3.5 %; a step of third order, then one of second.
    Float y = bits_float(UInt(0x5f375a86u) - (float_bits(a) >> 1));
    Float e = fma(-(a * y), y, Float(1));
    y = fma(y * e, fma(e, Float(0.375f), Float(0.5f)), y);
    e = fma(-(a * y), y, Float(1));
    return fma(y * Float(0.5f), e, y);
}

/// The n numbers (2, 3, or a multiple of 4) that each lane of m has from base[index] on; base's, or 0, in others.
template <int n>
[[gnu::always_inline]] inline void gather_row_or_first(const float* base, UInt index, Mask m, Float (&row)[n])
{
    if (none(m)) {
        for (Float& x : row) x = Float(0);
        return;
    }
    // Where a lane has a row there is a first one.
    const UInt at = select(m, index, UInt(0u));
    if constexpr (n < 4)
        gather_row(base, at, row);
    else
        for (int k = 0; k < n; k += 4) {
            Float four[4];
            gather_row(base + k, at, four);
            for (int i = 0; i < 4; ++i) row[k + i] = four[i];
        }
}
/// The same; 0 in others.
template <int n>
[[gnu::always_inline]] inline void gather_row(const float* base, UInt index, Mask m, Float (&row)[n])
{
    gather_row_or_first(base, index, m, row);
    for (Float& x : row) x = select(m, x, Float(0));
}

/// Calls f(lane) for each lane of the mask, in ascending order.
template <class F>
void for_each_active(Mask m, F&& f)
{
    for (std::uint32_t bits = mask_bits(m); bits; bits &= bits - 1) f(std::countr_zero(bits));
}

/// Calls f(id, lanes with that id) for each different id among the lanes of the mask.
template <class F>
void for_each_unique(Mask m, UInt ids, F&& f)
{
    std::uint32_t values[lanes];
    store(values, ids);
    for (std::uint32_t bits = mask_bits(m); bits;) {
        const std::uint32_t id = values[std::countr_zero(bits)];
        const Mask same = mask_from_bits(bits) & (ids == UInt(id));
        f(id, same);
        bits &= ~mask_bits(same);
    }
}

}  // namespace FATHOM_LANES
}  // namespace fathom
