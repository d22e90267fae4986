// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Base back end of math/lanes.h: one lane of plain types. Its comments document the operations of every back end.
#include <bit>
#include <cmath>
#include <cstdint>

namespace fathom::scalar {

using Float = float;
using UInt = std::uint32_t;
using Mask = bool;
inline constexpr int lanes = 1;
inline constexpr const char* lanes_name = "base";

inline Float load(const float* p) { return *p; }
inline UInt load(const std::uint32_t* p) { return *p; }
inline void store(float* p, Float a) { *p = a; }
inline void store(std::uint32_t* p, UInt a) { *p = a; }
/// The index of each lane: 0, 1, ..., lanes - 1.
inline UInt iota() { return 0; }
/// Bit i of the result is lane i of the mask.
inline std::uint32_t mask_bits(Mask m) { return m; }
inline Mask mask_from_bits(std::uint32_t bits) { return bits & 1; }
/// Mask of the lanes with index below n.
inline Mask first_lanes(std::size_t n) { return n > 0; }
inline bool any(Mask m) { return m; }
inline bool none(Mask m) { return !m; }

/// a * b + c with one rounding.
inline Float fma(Float a, Float b, Float c) { return std::fma(a, b, c); }
inline Float sqrt(Float a) { return std::sqrt(a); }
inline Float floor(Float a) { return std::floor(a); }
inline Float min(Float a, Float b) { return a < b ? a : b; }
inline Float max(Float a, Float b) { return a > b ? a : b; }
/// Returns m ? a : b in each lane.
inline Float select(Mask m, Float a, Float b) { return m ? a : b; }
inline UInt select(Mask m, UInt a, UInt b) { return m ? a : b; }
/// Reinterprets the bits of a float as an integer; bits_float() is the inverse.
inline UInt float_bits(Float a) { return std::bit_cast<UInt>(a); }
inline Float bits_float(UInt a) { return std::bit_cast<Float>(a); }
/// Converts a signed 32-bit integer to float.
inline Float to_float(UInt a) { return Float(std::int32_t(a)); }
/// Converts to an integer, rounding toward zero; the value must lie within the range of int32.
inline UInt to_uint(Float a) { return UInt(std::int32_t(a)); }
/// Signed comparison a < b.
inline Mask less(UInt a, UInt b) { return std::int32_t(a) < std::int32_t(b); }

/// Loads base[index] in each lane.
inline Float gather(const float* base, UInt index) { return base[index]; }
inline UInt gather(const std::uint32_t* base, UInt index) { return base[index]; }
/// Loads base[index] in the lanes of m; other lanes read nothing and get 0.
inline Float gather(const float* base, UInt index, Mask m) { return m ? base[index] : 0.f; }
inline UInt gather(const std::uint32_t* base, UInt index, Mask m) { return m ? base[index] : 0u; }
/// Loads row[k] = base[index + k] for k < n; n is 2, 3 or 4. It is faster than n gathers because each lane reads its
/// row at once.
template <int n>
inline void gather_row(const float* base, UInt index, Float (&row)[n])
{
    for (int k = 0; k < n; ++k) row[k] = base[std::size_t(index) + std::size_t(k)];
}
/// Stores the lanes of the mask side by side from p on. It may write up to `lanes` elements, of which those past the
/// last lane of the mask are undefined.
inline void compress_store(float* p, Float a, Mask m)
{
    if (m) *p = a;
}
inline void compress_store(std::uint32_t* p, UInt a, Mask m)
{
    if (m) *p = a;
}
/// The value of one lane.
inline float extract(Float a, int) { return a; }
inline std::uint32_t extract(UInt a, int) { return a; }
inline UInt reverse_bits(UInt x)
{
    x = __builtin_bswap32(x);
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

/// Reads table[index] from 32 floats, of which the first n are in use; any index is safe.
inline Float lookup(const float* table, int, UInt index) { return table[index & 31]; }
inline UInt lookup(const std::uint32_t* table, int, UInt index) { return table[index & 31]; }
/// The minimum over all lanes.
inline float least(Float a) { return a; }
/// Sets out[i] to the minimum over the lanes of x[i].
inline void reduce_min_each(const Float (&x)[16], float (&out)[16])
{
    for (int i = 0; i < 16; ++i) out[i] = x[i];
}
/// Inclusive prefix sums: lane i gets the sum of lanes 0 to i.
inline UInt prefix_sums(UInt a) { return a; }
/// Rotates each integer by 16 bits.
inline UInt rotate16(UInt x) { return x >> 16 | x << 16; }

}  // namespace fathom::scalar
namespace fathom {
namespace native = scalar;
}
