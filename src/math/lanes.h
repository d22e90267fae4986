// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lanes: Float, UInt and Mask hold N floats, 32-bit integers and booleans. N = `lanes` follows from the instruction
/// set the file is compiled for: 16 (AVX-512), 8 (AVX2) or 1 (plain types, runs anywhere).
///
/// Every operation gives bitwise equal results at each width. Arithmetic takes no mask: idle lanes compute values that
/// are never read. There are no estimates (rcp, rsqrt) and no sums across lanes. min(a, b) is a < b ? a : b and max(a,
/// b) is a > b ? a : b, NaN included. UInt arithmetic wraps; its comparisons and conversions are signed, so compared
/// values stay below 2^31. Intrinsics appear only in lanes_*.h and in leaf functions of the BVH. lanes_scalar.h
/// documents each operation.
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

/// FATHOM_ONE_LANE selects one lane on every instruction set, for files whose functions process a single item per call.
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

/// All code that depends on the number of lanes lives in this inline namespace. Two files of one library may use
/// different numbers, and the linker must not merge their functions.
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
// Each operation is named by a using declaration, because arguments of type float (in the base build) have no
// associated namespace.
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
using native::none;
using native::reduce_min_each;
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

/// The largest table that lookup() can hold in registers. lookup() may read this many entries from the start of any
/// table.
inline constexpr int lookup_size = 32;

/// Reads table[index] from a table padded for lookup(), of any size. Every index must be below n.
inline UInt lookup_or_gather(const std::uint32_t* table, int n, UInt index)
{
    return n <= lookup_size ? lookup(table, n, index) : gather(table, index);
}
/// Reads table[index] for the lanes of m, whose indices must be below n; 0 in other lanes, with any index.
inline UInt lookup_or_gather(const std::uint32_t* table, int n, UInt index, Mask m)
{
    return n <= lookup_size ? select(m, lookup(table, n, index), UInt(0u)) : gather(table, index, m);
}

inline Float abs(Float a) { return bits_float(float_bits(a) & UInt(0x7fffffffu)); }
/// Magnitude of a with the sign of b.
inline Float copysign(Float a, Float b)
{
    return bits_float((float_bits(a) & UInt(0x7fffffffu)) | (float_bits(b) & UInt(0x80000000u)));
}
/// Returns a with its sign flipped if b is negative or -0.
inline Float flip_sign(Float a, Float b) { return bits_float(float_bits(a) ^ (float_bits(b) & UInt(0x80000000u))); }
inline Float clamp(Float a, Float lo, Float hi) { return min(max(a, lo), hi); }
inline Mask equal(Mask a, Mask b) { return (a & b) | !(a | b); }
inline bool all(Mask m) { return none(!m); }
inline int count(Mask m) { return std::popcount(mask_bits(m)); }

/// Reciprocal 1 / a to within 2 ulp, for normal a > 0 with a normal reciprocal. It consists of multiplications, which
/// pipeline, whereas a division stalls. The initial guess is integer arithmetic because the estimates of processors
/// differ by vendor.
inline Float reciprocal(Float a)
{
    // Mirroring the exponent gives a guess with an error below 12 %; each step cubes the error.
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
    // The initial guess is off by at most 3.5 %; a step of third order and one of second order refine it.
    Float y = bits_float(UInt(0x5f375a86u) - (float_bits(a) >> 1));
    Float e = fma(-(a * y), y, Float(1));
    y = fma(y * e, fma(e, Float(0.375f), Float(0.5f)), y);
    e = fma(-(a * y), y, Float(1));
    return fma(y * Float(0.5f), e, y);
}

/// Loads row[k] = base[index + k] for k < n in the lanes of m; n is 2, 3 or a multiple of 4. Other lanes get the row at
/// `base`, or 0 if m is empty: they never read out of bounds.
template <int n>
[[gnu::always_inline]] inline void gather_row_or_first(const float* base, UInt index, Mask m, Float (&row)[n])
{
    if (none(m)) {
        for (Float& x : row) x = Float(0);
        return;
    }
    // If any lane has a row, the array has a first one, which idle lanes can read safely.
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
/// Loads row[k] = base[index + k] for k < n in the lanes of m; 0 in other lanes. n is 2, 3 or a multiple of 4.
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

/// Calls f(id, mask of the lanes with that id) once for each distinct id among the lanes of the mask.
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
