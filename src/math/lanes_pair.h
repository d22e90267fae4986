// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lanes as pairs of registers: each operation is two independent instructions, which hide each other's latency.
/// math/lanes.h includes this file after a lanes_*.h that defines `native`.
#include <bit>

namespace fathom {
inline namespace FATHOM_LANES {

inline constexpr int lanes = 2 * native::lanes;
inline constexpr const char* lanes_name = native::lanes_name;

struct Mask {
    native::Mask a, b;
    Mask() = default;
    Mask(native::Mask x, native::Mask y) : a(x), b(y) {}
    explicit Mask(bool v) : a(v), b(v) {}
};
struct Float {
    native::Float a, b;
    Float() = default;
    Float(native::Float x, native::Float y) : a(x), b(y) {}
    Float(float x) : a(x), b(a) {}
};
struct UInt {
    native::UInt a, b;
    UInt() = default;
    UInt(native::UInt x, native::UInt y) : a(x), b(y) {}
    UInt(std::uint32_t x) : a(x), b(a) {}
};

inline Float load(const float* p) { return {native::load(p), native::load(p + native::lanes)}; }
inline UInt load(const std::uint32_t* p) { return {native::load(p), native::load(p + native::lanes)}; }
inline void store(float* p, Float x) { native::store(p, x.a), native::store(p + native::lanes, x.b); }
inline void store(std::uint32_t* p, UInt x) { native::store(p, x.a), native::store(p + native::lanes, x.b); }
inline UInt iota() { return {native::iota(), native::iota() + native::UInt(std::uint32_t(native::lanes))}; }

inline std::uint32_t mask_bits(Mask m) { return native::mask_bits(m.a) | native::mask_bits(m.b) << native::lanes; }
inline Mask mask_from_bits(std::uint32_t bits)
{
    return {native::mask_from_bits(bits & ((1u << native::lanes) - 1)), native::mask_from_bits(bits >> native::lanes)};
}
inline Mask first_lanes(std::size_t n)
{
    return {native::first_lanes(n), native::first_lanes(n > native::lanes ? n - native::lanes : 0)};
}
inline bool any(Mask m) { return native::any(m.a | m.b); }
inline bool none(Mask m) { return native::none(m.a | m.b); }
inline Mask operator!(Mask x) { return {!x.a, !x.b}; }
inline Mask operator&(Mask x, Mask y) { return {x.a & y.a, x.b & y.b}; }
inline Mask operator|(Mask x, Mask y) { return {x.a | y.a, x.b | y.b}; }
inline Mask& operator&=(Mask& x, Mask y) { return x = x & y; }
inline Mask& operator|=(Mask& x, Mask y) { return x = x | y; }

inline Float operator+(Float x, Float y) { return {x.a + y.a, x.b + y.b}; }
inline Float operator-(Float x, Float y) { return {x.a - y.a, x.b - y.b}; }
inline Float operator*(Float x, Float y) { return {x.a * y.a, x.b * y.b}; }
inline Float operator/(Float x, Float y) { return {x.a / y.a, x.b / y.b}; }
inline Float& operator+=(Float& x, Float y) { return x = x + y; }
inline Float& operator-=(Float& x, Float y) { return x = x - y; }
inline Float& operator*=(Float& x, Float y) { return x = x * y; }
inline Mask operator<(Float x, Float y) { return {x.a < y.a, x.b < y.b}; }
inline Mask operator<=(Float x, Float y) { return {x.a <= y.a, x.b <= y.b}; }
inline Mask operator>(Float x, Float y) { return {x.a > y.a, x.b > y.b}; }
inline Mask operator>=(Float x, Float y) { return {x.a >= y.a, x.b >= y.b}; }
inline Mask operator==(Float x, Float y) { return {x.a == y.a, x.b == y.b}; }
inline Mask operator!=(Float x, Float y) { return {x.a != y.a, x.b != y.b}; }

inline UInt operator+(UInt x, UInt y) { return {x.a + y.a, x.b + y.b}; }
inline UInt operator-(UInt x, UInt y) { return {x.a - y.a, x.b - y.b}; }
inline UInt operator*(UInt x, UInt y) { return {x.a * y.a, x.b * y.b}; }
inline UInt operator&(UInt x, UInt y) { return {x.a & y.a, x.b & y.b}; }
inline UInt operator|(UInt x, UInt y) { return {x.a | y.a, x.b | y.b}; }
inline UInt operator^(UInt x, UInt y) { return {x.a ^ y.a, x.b ^ y.b}; }
inline UInt& operator+=(UInt& x, UInt y) { return x = x + y; }
inline UInt& operator^=(UInt& x, UInt y) { return x = x ^ y; }
inline UInt& operator*=(UInt& x, UInt y) { return x = x * y; }
inline Mask operator==(UInt x, UInt y) { return {x.a == y.a, x.b == y.b}; }
inline Mask operator!=(UInt x, UInt y) { return {x.a != y.a, x.b != y.b}; }
inline UInt operator<<(UInt x, int n) { return {x.a << n, x.b << n}; }
inline UInt operator>>(UInt x, int n) { return {x.a >> n, x.b >> n}; }

inline Float operator-(Float x) { return {-x.a, -x.b}; }
inline Mask less(UInt x, UInt y) { return {native::less(x.a, y.a), native::less(x.b, y.b)}; }
inline Float fma(Float x, Float y, Float z) { return {native::fma(x.a, y.a, z.a), native::fma(x.b, y.b, z.b)}; }
inline Float sqrt(Float x) { return {native::sqrt(x.a), native::sqrt(x.b)}; }
inline Float floor(Float x) { return {native::floor(x.a), native::floor(x.b)}; }
inline Float min(Float x, Float y) { return {native::min(x.a, y.a), native::min(x.b, y.b)}; }
inline Float max(Float x, Float y) { return {native::max(x.a, y.a), native::max(x.b, y.b)}; }
inline Float select(Mask m, Float x, Float y) { return {native::select(m.a, x.a, y.a), native::select(m.b, x.b, y.b)}; }
inline UInt select(Mask m, UInt x, UInt y) { return {native::select(m.a, x.a, y.a), native::select(m.b, x.b, y.b)}; }
inline UInt float_bits(Float x) { return {native::float_bits(x.a), native::float_bits(x.b)}; }
inline Float bits_float(UInt x) { return {native::bits_float(x.a), native::bits_float(x.b)}; }
inline Float to_float(UInt x) { return {native::to_float(x.a), native::to_float(x.b)}; }
inline UInt to_uint(Float x) { return {native::to_uint(x.a), native::to_uint(x.b)}; }
inline UInt reverse_bits(UInt x) { return {native::reverse_bits(x.a), native::reverse_bits(x.b)}; }

inline Float gather(const float* p, UInt i) { return {native::gather(p, i.a), native::gather(p, i.b)}; }
inline Float gather(const float* p, UInt i, Mask m)
{
    return {native::gather(p, i.a, m.a), native::gather(p, i.b, m.b)};
}
template <int n>
inline void gather_row(const float* p, UInt i, Float (&row)[n])
{
    native::Float a[n], b[n];
    native::gather_row(p, i.a, a), native::gather_row(p, i.b, b);
    for (int k = 0; k < n; ++k) row[k] = {a[k], b[k]};
}
inline void compress_store(float* p, Float x, Mask m)
{
    native::compress_store(p, x.a, m.a);
    native::compress_store(p + std::popcount(native::mask_bits(m.a)), x.b, m.b);
}
inline UInt gather(const std::uint32_t* p, UInt i) { return {native::gather(p, i.a), native::gather(p, i.b)}; }
inline UInt gather(const std::uint32_t* p, UInt i, Mask m)
{
    return {native::gather(p, i.a, m.a), native::gather(p, i.b, m.b)};
}
inline void compress_store(std::uint32_t* p, UInt x, Mask m)
{
    native::compress_store(p, x.a, m.a);
    native::compress_store(p + std::popcount(native::mask_bits(m.a)), x.b, m.b);
}
inline Float lookup(const float* t, int n, UInt i) { return {native::lookup(t, n, i.a), native::lookup(t, n, i.b)}; }
inline UInt lookup(const std::uint32_t* t, int n, UInt i)
{
    return {native::lookup(t, n, i.a), native::lookup(t, n, i.b)};
}
inline float least(Float x) { return native::least(native::min(x.a, x.b)); }
inline void reduce_min_each(const Float (&x)[16], float (&out)[16])
{
    native::Float lesser[16];
    for (int i = 0; i < 16; ++i) lesser[i] = native::min(x[i].a, x[i].b);
    native::reduce_min_each(lesser, out);
}
inline UInt rotate16(UInt x) { return {native::rotate16(x.a), native::rotate16(x.b)}; }

}  // namespace FATHOM_LANES
}  // namespace fathom
