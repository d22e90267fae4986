// SPDX-License-Identifier: Apache-2.0
#pragma once
/// AVX2 back end of math/lanes.h: 8 lanes; masks are full vectors. lanes_scalar.h documents the operations.
#include <immintrin.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace fathom::avx2 {

inline constexpr int lanes = 8;
inline constexpr const char* lanes_name = "AVX2";

struct Mask {
    __m256 v;
    Mask() = default;
    Mask(__m256 m) : v(m) {}
    Mask(__m256i m) : v(_mm256_castsi256_ps(m)) {}
    explicit Mask(bool b) : v(_mm256_castsi256_ps(_mm256_set1_epi32(b ? -1 : 0))) {}
};
struct Float {
    __m256 v;
    Float() = default;
    Float(__m256 x) : v(x) {}
    Float(float x) : v(_mm256_set1_ps(x)) {}
};
struct UInt {
    __m256i v;
    UInt() = default;
    UInt(__m256i x) : v(x) {}
    UInt(std::uint32_t x) : v(_mm256_set1_epi32(int(x))) {}
};

inline Float load(const float* p) { return _mm256_loadu_ps(p); }
inline UInt load(const std::uint32_t* p) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)); }
inline void store(float* p, Float a) { _mm256_storeu_ps(p, a.v); }
inline void store(std::uint32_t* p, UInt a) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v); }
inline UInt iota() { return _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7); }

inline std::uint32_t mask_bits(Mask m) { return std::uint32_t(_mm256_movemask_ps(m.v)); }
inline Mask mask_from_bits(std::uint32_t bits)
{
    const __m256i one = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(int(bits)), one), one);
}
inline Mask first_lanes(std::size_t n)
{
    return _mm256_cmpgt_epi32(_mm256_set1_epi32(n > 8 ? 8 : int(n)), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
}
inline bool any(Mask m) { return !_mm256_testz_ps(m.v, m.v); }
inline bool none(Mask m) { return _mm256_testz_ps(m.v, m.v); }
inline Mask operator&(Mask a, Mask b) { return _mm256_and_ps(a.v, b.v); }
inline Mask operator|(Mask a, Mask b) { return _mm256_or_ps(a.v, b.v); }
inline Mask operator!(Mask a) { return _mm256_xor_ps(a.v, _mm256_castsi256_ps(_mm256_set1_epi32(-1))); }
inline Mask& operator&=(Mask& a, Mask b) { return a = a & b; }
inline Mask& operator|=(Mask& a, Mask b) { return a = a | b; }

inline Float operator+(Float a, Float b) { return _mm256_add_ps(a.v, b.v); }
inline Float operator-(Float a, Float b) { return _mm256_sub_ps(a.v, b.v); }
inline Float operator*(Float a, Float b) { return _mm256_mul_ps(a.v, b.v); }
inline Float operator/(Float a, Float b) { return _mm256_div_ps(a.v, b.v); }
inline Float& operator+=(Float& a, Float b) { return a = a + b; }
inline Float& operator-=(Float& a, Float b) { return a = a - b; }
inline Float& operator*=(Float& a, Float b) { return a = a * b; }
inline Mask operator<(Float a, Float b) { return _mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ); }
inline Mask operator<=(Float a, Float b) { return _mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ); }
inline Mask operator>(Float a, Float b) { return _mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ); }
inline Mask operator>=(Float a, Float b) { return _mm256_cmp_ps(a.v, b.v, _CMP_GE_OQ); }
inline Mask operator==(Float a, Float b) { return _mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ); }
inline Mask operator!=(Float a, Float b) { return _mm256_cmp_ps(a.v, b.v, _CMP_NEQ_UQ); }
inline Float fma(Float a, Float b, Float c) { return _mm256_fmadd_ps(a.v, b.v, c.v); }
inline Float sqrt(Float a) { return _mm256_sqrt_ps(a.v); }
inline Float floor(Float a) { return _mm256_floor_ps(a.v); }
inline Float min(Float a, Float b) { return _mm256_min_ps(a.v, b.v); }
inline Float max(Float a, Float b) { return _mm256_max_ps(a.v, b.v); }
inline Float select(Mask m, Float a, Float b) { return _mm256_blendv_ps(b.v, a.v, m.v); }

inline UInt operator+(UInt a, UInt b) { return _mm256_add_epi32(a.v, b.v); }
inline UInt operator-(UInt a, UInt b) { return _mm256_sub_epi32(a.v, b.v); }
inline UInt operator*(UInt a, UInt b) { return _mm256_mullo_epi32(a.v, b.v); }
inline UInt operator&(UInt a, UInt b) { return _mm256_and_si256(a.v, b.v); }
inline UInt operator|(UInt a, UInt b) { return _mm256_or_si256(a.v, b.v); }
inline UInt operator^(UInt a, UInt b) { return _mm256_xor_si256(a.v, b.v); }
inline UInt operator<<(UInt a, int n) { return _mm256_slli_epi32(a.v, n); }
inline UInt operator>>(UInt a, int n) { return _mm256_srli_epi32(a.v, n); }
inline UInt& operator+=(UInt& a, UInt b) { return a = a + b; }
inline UInt& operator^=(UInt& a, UInt b) { return a = a ^ b; }
inline UInt& operator*=(UInt& a, UInt b) { return a = a * b; }
inline Mask operator==(UInt a, UInt b) { return _mm256_cmpeq_epi32(a.v, b.v); }
inline Mask operator!=(UInt a, UInt b) { return !(a == b); }
inline Mask less(UInt a, UInt b) { return _mm256_cmpgt_epi32(b.v, a.v); }
inline UInt select(Mask m, UInt a, UInt b)
{
    return _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(b.v), _mm256_castsi256_ps(a.v), m.v));
}
inline UInt float_bits(Float a) { return _mm256_castps_si256(a.v); }
inline Float bits_float(UInt a) { return _mm256_castsi256_ps(a.v); }
inline Float to_float(UInt a) { return _mm256_cvtepi32_ps(a.v); }
inline UInt to_uint(Float a) { return _mm256_cvttps_epi32(a.v); }
inline Float operator-(Float a) { return -a.v; }

inline Float gather(const float* base, UInt index) { return _mm256_i32gather_ps(base, index.v, 4); }
inline UInt gather(const std::uint32_t* base, UInt index)
{
    return _mm256_i32gather_epi32(reinterpret_cast<const int*>(base), index.v, 4);
}
inline Float gather(const float* base, UInt index, Mask m)
{
    return _mm256_mask_i32gather_ps(_mm256_setzero_ps(), base, index.v, m.v, 4);
}
inline UInt gather(const std::uint32_t* base, UInt index, Mask m)
{
    return _mm256_mask_i32gather_epi32(_mm256_setzero_si256(), reinterpret_cast<const int*>(base), index.v,
                                       _mm256_castps_si256(m.v), 4);
}

template <int n>
inline void gather_row(const float* base, UInt index, Float (&row)[n])
{
    static_assert(n == 2 || n == 3 || n == 4);
    alignas(32) std::uint32_t at[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(at), index.v);
    const auto read = [&](int lane) {
        const float* from = base + at[lane];
        // The read must not extend past the row, which may be the last one of its array.
        if constexpr (n == 2) return _mm_castsi128_ps(_mm_loadu_si64(from));
        if constexpr (n == 3) return _mm_maskload_ps(from, _mm_setr_epi32(-1, -1, -1, 0));
        return _mm_loadu_ps(from);
    };
    // Each register holds the rows of lanes k and k + 4; then each half is transposed as a 4 by 4 matrix.
    __m256 r[4];
    for (int k = 0; k < 4; ++k) r[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(read(k)), read(k + 4), 1);
    const __m256 low = _mm256_unpacklo_ps(r[0], r[1]), high = _mm256_unpackhi_ps(r[0], r[1]),
                 low2 = _mm256_unpacklo_ps(r[2], r[3]), high2 = _mm256_unpackhi_ps(r[2], r[3]);
    row[0] = _mm256_shuffle_ps(low, low2, 0x44);
    row[1] = _mm256_shuffle_ps(low, low2, 0xee);
    if constexpr (n > 2) row[2] = _mm256_shuffle_ps(high, high2, 0x44);
    if constexpr (n > 3) row[3] = _mm256_shuffle_ps(high, high2, 0xee);
}

namespace table {

/// Indices of the set lanes of each mask of 8 lanes, packed side by side, one byte each.
inline constexpr auto compress_table = [] {
    std::array<std::uint64_t, 256> table{};
    for (unsigned mask = 0; mask < 256; ++mask)
        for (unsigned lane = 0, to = 0; lane < 8; ++lane)
            if (mask >> lane & 1) table[mask] |= std::uint64_t(lane) << 8 * to++;
    return table;
}();

inline __m256 compress(__m256 a, Mask m)
{
    const __m256i order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(compress_table[mask_bits(m)])));
    return _mm256_permutevar8x32_ps(a, order);
}

}  // namespace table

inline void compress_store(float* p, Float a, Mask m) { _mm256_storeu_ps(p, table::compress(a.v, m)); }
inline void compress_store(std::uint32_t* p, UInt a, Mask m)
{
    _mm256_storeu_ps(reinterpret_cast<float*>(p), table::compress(_mm256_castsi256_ps(a.v), m));
}
inline float extract(Float a, int lane)
{
    alignas(32) float x[8];
    _mm256_store_ps(x, a.v);
    return x[lane];
}
inline std::uint32_t extract(UInt a, int lane)
{
    alignas(32) std::uint32_t x[8];
    _mm256_store_si256(reinterpret_cast<__m256i*>(x), a.v);
    return x[lane];
}
inline UInt reverse_bits(UInt x)
{
    // The bytes of each word are swapped, then a table reverses each nibble. The low nibble's table is shifted up,
    // which swaps the nibbles.
    const __m256i bytes =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
    const __m256i high =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
    const __m256i low = _mm256_slli_epi16(high, 4);
    const __m256i mask = _mm256_set1_epi8(0x0f);
    const __m256i y = _mm256_shuffle_epi8(x.v, bytes);
    return _mm256_or_si256(_mm256_shuffle_epi8(low, _mm256_and_si256(y, mask)),
                           _mm256_shuffle_epi8(high, _mm256_and_si256(_mm256_srli_epi16(y, 4), mask)));
}

/// Reads table[index] from 32 floats, of which the first n are in use; any index is safe. Tables of up to 16 entries
/// are held in registers.
inline Float lookup(const float* table, int n, UInt index)
{
    const __m256 low = _mm256_permutevar8x32_ps(_mm256_loadu_ps(table), index.v);
    if (n <= 8) return low;
    if (n <= 16) {
        const __m256 high = _mm256_permutevar8x32_ps(_mm256_loadu_ps(table + 8), index.v);
        return _mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32(index.v, 28)));
    }
    return _mm256_i32gather_ps(table, _mm256_and_si256(index.v, _mm256_set1_epi32(31)), 4);
}
inline UInt lookup(const std::uint32_t* table, int n, UInt index)
{
    return _mm256_castps_si256(lookup(reinterpret_cast<const float*>(table), n, index).v);
}
/// The minimum over all lanes.
inline float least(Float a)
{
    __m128 x = _mm_min_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
    x = _mm_min_ps(x, _mm_movehl_ps(x, x));
    return _mm_cvtss_f32(_mm_min_ss(x, _mm_movehdup_ps(x)));
}
/// Sets out[i] to the minimum over the lanes of x[i].
inline void reduce_min_each(const Float (&x)[16], float (&out)[16])
{
    // singles(a, b) leaves partial minima of a and b in alternating lanes (a b a b ...); doubles extends that to a b c
    // d in each half.
    const auto singles = [](__m256 a, __m256 b) {
        return _mm256_min_ps(_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
    };
    const auto doubles = [](__m256 a, __m256 b) {
        const __m256d p = _mm256_castps_pd(a), q = _mm256_castps_pd(b);
        return _mm256_min_ps(_mm256_castpd_ps(_mm256_unpacklo_pd(p, q)), _mm256_castpd_ps(_mm256_unpackhi_pd(p, q)));
    };
    const auto four = [&](const Float* f) { return doubles(singles(f[0].v, f[1].v), singles(f[2].v, f[3].v)); };
    for (int i = 0; i < 16; i += 8) {
        const __m256 a = four(x + i), b = four(x + i + 4);
        _mm256_storeu_ps(out + i,
                         _mm256_min_ps(_mm256_permute2f128_ps(a, b, 0x20), _mm256_permute2f128_ps(a, b, 0x31)));
    }
}
/// Inclusive prefix sums: lane i gets the sum of lanes 0 to i.
inline UInt prefix_sums(UInt a)
{
    __m256i x = a.v;
    x = _mm256_add_epi32(x, _mm256_slli_si256(x, 4));
    x = _mm256_add_epi32(x, _mm256_slli_si256(x, 8));
    // Broadcasts the sum of the lower half to all lanes of the upper half.
    const __m256i lower = _mm256_permutevar8x32_epi32(x, _mm256_set1_epi32(3));
    return _mm256_add_epi32(x, _mm256_blend_epi32(_mm256_setzero_si256(), lower, 0xf0));
}
inline UInt rotate16(UInt x)
{
    const __m256i words =
        _mm256_broadcastsi128_si256(_mm_setr_epi8(2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13));
    return _mm256_shuffle_epi8(x.v, words);
}

}  // namespace fathom::avx2
namespace fathom {
namespace native = avx2;
}
