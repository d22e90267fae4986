// SPDX-License-Identifier: Apache-2.0
#pragma once
/// AVX-512 back end of math/lanes.h: 16 lanes, native mask registers. lanes_scalar.h documents the operations.
#include <immintrin.h>

#include <cstddef>
#include <cstdint>

namespace fathom::avx512 {

inline constexpr int lanes = 16;
inline constexpr const char* lanes_name = "AVX-512";

// The mask is as wide as a general register: compilers would pack a pair of narrower masks into one register and shift
// them in and out.
struct alignas(8) Mask {
    __mmask16 v;
    Mask() = default;
    Mask(__mmask16 m) : v(m) {}
    explicit Mask(bool b) : v(b ? 0xffff : 0) {}
};
struct Float {
    __m512 v;
    Float() = default;
    Float(__m512 x) : v(x) {}
    Float(float x) : v(_mm512_set1_ps(x)) {}
};
struct UInt {
    __m512i v;
    UInt() = default;
    UInt(__m512i x) : v(x) {}
    UInt(std::uint32_t x) : v(_mm512_set1_epi32(int(x))) {}
};

inline Float load(const float* p) { return _mm512_loadu_ps(p); }
inline UInt load(const std::uint32_t* p) { return _mm512_loadu_si512(p); }
inline void store(float* p, Float a) { _mm512_storeu_ps(p, a.v); }
inline void store(std::uint32_t* p, UInt a) { _mm512_storeu_si512(p, a.v); }
inline UInt iota() { return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15); }

inline std::uint32_t mask_bits(Mask m) { return m.v; }
inline Mask mask_from_bits(std::uint32_t bits) { return __mmask16(bits); }
inline Mask first_lanes(std::size_t n) { return n >= 16 ? __mmask16(0xffff) : __mmask16((1u << n) - 1); }
inline bool any(Mask m) { return m.v != 0; }
inline bool none(Mask m) { return m.v == 0; }
inline Mask operator&(Mask a, Mask b) { return __mmask16(a.v & b.v); }
inline Mask operator|(Mask a, Mask b) { return __mmask16(a.v | b.v); }
inline Mask operator!(Mask a) { return __mmask16(~a.v); }
inline Mask& operator&=(Mask& a, Mask b) { return a = a & b; }
inline Mask& operator|=(Mask& a, Mask b) { return a = a | b; }

inline Float operator+(Float a, Float b) { return _mm512_add_ps(a.v, b.v); }
inline Float operator-(Float a, Float b) { return _mm512_sub_ps(a.v, b.v); }
inline Float operator*(Float a, Float b) { return _mm512_mul_ps(a.v, b.v); }
inline Float operator/(Float a, Float b) { return _mm512_div_ps(a.v, b.v); }
inline Float& operator+=(Float& a, Float b) { return a = a + b; }
inline Float& operator-=(Float& a, Float b) { return a = a - b; }
inline Float& operator*=(Float& a, Float b) { return a = a * b; }
inline Mask operator<(Float a, Float b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ); }
inline Mask operator<=(Float a, Float b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ); }
inline Mask operator>(Float a, Float b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_GT_OQ); }
inline Mask operator>=(Float a, Float b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_GE_OQ); }
inline Mask operator==(Float a, Float b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_EQ_OQ); }
inline Mask operator!=(Float a, Float b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_NEQ_UQ); }
inline Float fma(Float a, Float b, Float c) { return _mm512_fmadd_ps(a.v, b.v, c.v); }
inline Float sqrt(Float a) { return _mm512_sqrt_ps(a.v); }
inline Float floor(Float a) { return _mm512_roundscale_ps(a.v, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
inline Float min(Float a, Float b) { return _mm512_min_ps(a.v, b.v); }
inline Float max(Float a, Float b) { return _mm512_max_ps(a.v, b.v); }
inline Float select(Mask m, Float a, Float b) { return _mm512_mask_blend_ps(m.v, b.v, a.v); }

inline UInt operator+(UInt a, UInt b) { return _mm512_add_epi32(a.v, b.v); }
inline UInt operator-(UInt a, UInt b) { return _mm512_sub_epi32(a.v, b.v); }
inline UInt operator*(UInt a, UInt b) { return _mm512_mullo_epi32(a.v, b.v); }
inline UInt operator&(UInt a, UInt b) { return _mm512_and_si512(a.v, b.v); }
inline UInt operator|(UInt a, UInt b) { return _mm512_or_si512(a.v, b.v); }
inline UInt operator^(UInt a, UInt b) { return _mm512_xor_si512(a.v, b.v); }
inline UInt operator<<(UInt a, int n) { return _mm512_slli_epi32(a.v, unsigned(n)); }
inline UInt operator>>(UInt a, int n) { return _mm512_srli_epi32(a.v, unsigned(n)); }
inline UInt& operator+=(UInt& a, UInt b) { return a = a + b; }
inline UInt& operator^=(UInt& a, UInt b) { return a = a ^ b; }
inline UInt& operator*=(UInt& a, UInt b) { return a = a * b; }
inline Mask operator==(UInt a, UInt b) { return _mm512_cmpeq_epi32_mask(a.v, b.v); }
inline Mask operator!=(UInt a, UInt b) { return _mm512_cmpneq_epi32_mask(a.v, b.v); }
inline Mask less(UInt a, UInt b) { return _mm512_cmplt_epi32_mask(a.v, b.v); }
inline UInt select(Mask m, UInt a, UInt b) { return _mm512_mask_blend_epi32(m.v, b.v, a.v); }
inline UInt float_bits(Float a) { return _mm512_castps_si512(a.v); }
inline Float bits_float(UInt a) { return _mm512_castsi512_ps(a.v); }
inline Float to_float(UInt a) { return _mm512_cvtepi32_ps(a.v); }
inline UInt to_uint(Float a) { return _mm512_cvttps_epi32(a.v); }
inline Float operator-(Float a) { return -a.v; }

inline Float gather(const float* base, UInt index) { return _mm512_i32gather_ps(index.v, base, 4); }
inline UInt gather(const std::uint32_t* base, UInt index) { return _mm512_i32gather_epi32(index.v, base, 4); }
inline Float gather(const float* base, UInt index, Mask m)
{
    return _mm512_mask_i32gather_ps(_mm512_setzero_ps(), m.v, index.v, base, 4);
}
inline UInt gather(const std::uint32_t* base, UInt index, Mask m)
{
    return _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), m.v, index.v, base, 4);
}
template <int n>
inline void gather_row(const float* base, UInt index, Float (&row)[n])
{
    static_assert(n == 2 || n == 3 || n == 4);
    alignas(64) std::uint32_t at[16];
    _mm512_store_si512(at, index.v);
    const auto read = [&](int lane) {
        const float* from = base + at[lane];
        // The read must not extend past the row, which may be the last one of its array.
        if constexpr (n == 2) return _mm_castsi128_ps(_mm_loadu_si64(from));
        if constexpr (n == 3) return _mm_maskz_loadu_ps(7, from);
        return _mm_loadu_ps(from);
    };
    // Each register holds the rows of lanes k, k + 4, k + 8 and k + 12; then each quarter is transposed as a 4 by 4
    // matrix.
    __m512 r[4];
    for (int k = 0; k < 4; ++k) {
        const __m256 first = _mm256_insertf128_ps(_mm256_castps128_ps256(read(k)), read(k + 4), 1),
                     second = _mm256_insertf128_ps(_mm256_castps128_ps256(read(k + 8)), read(k + 12), 1);
        r[k] = _mm512_insertf32x8(_mm512_castps256_ps512(first), second, 1);
    }
    const __m512 low = _mm512_unpacklo_ps(r[0], r[1]), high = _mm512_unpackhi_ps(r[0], r[1]),
                 low2 = _mm512_unpacklo_ps(r[2], r[3]), high2 = _mm512_unpackhi_ps(r[2], r[3]);
    row[0] = _mm512_shuffle_ps(low, low2, 0x44);
    row[1] = _mm512_shuffle_ps(low, low2, 0xee);
    if constexpr (n > 2) row[2] = _mm512_shuffle_ps(high, high2, 0x44);
    if constexpr (n > 3) row[3] = _mm512_shuffle_ps(high, high2, 0xee);
}
// Compresses into a register and then stores: the memory form of the instruction is slow on Zen 4.
inline void compress_store(float* p, Float a, Mask m) { _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.v, a.v)); }
inline void compress_store(std::uint32_t* p, UInt a, Mask m)
{
    _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.v, a.v));
}
inline float extract(Float a, int lane)
{
    alignas(64) float x[16];
    _mm512_store_ps(x, a.v);
    return x[lane];
}
inline std::uint32_t extract(UInt a, int lane)
{
    alignas(64) std::uint32_t x[16];
    _mm512_store_si512(x, a.v);
    return x[lane];
}
inline UInt reverse_bits(UInt x)
{
    // The bytes of each word are swapped, then a table reverses each nibble. The low nibble's table is shifted up,
    // which swaps the nibbles.
    const __m512i bytes = _mm512_broadcast_i32x4(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
    const __m512i high = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
    const __m512i low = _mm512_slli_epi16(high, 4);
    const __m512i mask = _mm512_set1_epi8(0x0f);
    const __m512i y = _mm512_shuffle_epi8(x.v, bytes);
    return _mm512_or_si512(_mm512_shuffle_epi8(low, _mm512_and_si512(y, mask)),
                           _mm512_shuffle_epi8(high, _mm512_and_si512(_mm512_srli_epi16(y, 4), mask)));
}

/// Reads table[index] from 32 floats, of which the first n are in use; any index is safe. The table is held in
/// registers, without gathers.
inline Float lookup(const float* table, int n, UInt index)
{
    if (n <= 16) return _mm512_permutexvar_ps(index.v, _mm512_loadu_ps(table));
    return _mm512_permutex2var_ps(_mm512_loadu_ps(table), index.v, _mm512_loadu_ps(table + 16));
}
inline UInt lookup(const std::uint32_t* table, int n, UInt index)
{
    return _mm512_castps_si512(lookup(reinterpret_cast<const float*>(table), n, index).v);
}
/// The minimum over all lanes.
inline float least(Float a) { return _mm512_reduce_min_ps(a.v); }
/// Sets out[i] to the minimum over the lanes of x[i].
inline void reduce_min_each(const Float (&x)[16], float (&out)[16])
{
    // singles(a, b) leaves partial minima of a and b in alternating lanes (a b a b ...); doubles extends that to a b c
    // d in each quarter.
    const auto singles = [](__m512 a, __m512 b) {
        return _mm512_min_ps(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
    };
    const auto doubles = [](__m512 a, __m512 b) {
        const __m512d p = _mm512_castps_pd(a), q = _mm512_castps_pd(b);
        return _mm512_min_ps(_mm512_castpd_ps(_mm512_unpacklo_pd(p, q)), _mm512_castpd_ps(_mm512_unpackhi_pd(p, q)));
    };
    const auto four = [&](const Float* f) { return doubles(singles(f[0].v, f[1].v), singles(f[2].v, f[3].v)); };
    const auto quarters = [](__m512 a, __m512 b) {
        return _mm512_min_ps(_mm512_shuffle_f32x4(a, b, 0x44), _mm512_shuffle_f32x4(a, b, 0xee));
    };
    const __m512 low = quarters(four(x), four(x + 4)), high = quarters(four(x + 8), four(x + 12));
    _mm512_storeu_ps(out, _mm512_min_ps(_mm512_shuffle_f32x4(low, high, 0x88), _mm512_shuffle_f32x4(low, high, 0xdd)));
}
/// Inclusive prefix sums: lane i gets the sum of lanes 0 to i.
inline UInt prefix_sums(UInt a)
{
    const __m512i zero = _mm512_setzero_si512();
    __m512i x = a.v;
    x = _mm512_add_epi32(x, _mm512_alignr_epi32(x, zero, 15));
    x = _mm512_add_epi32(x, _mm512_alignr_epi32(x, zero, 14));
    x = _mm512_add_epi32(x, _mm512_alignr_epi32(x, zero, 12));
    return _mm512_add_epi32(x, _mm512_alignr_epi32(x, zero, 8));
}
inline UInt rotate16(UInt x) { return _mm512_rol_epi32(x.v, 16); }

}  // namespace fathom::avx512
namespace fathom {
namespace native = avx512;
}
