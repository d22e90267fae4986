#pragma once
#include <cmath>
#include <cstdint>

namespace fathom {

/// Exact sums of numbers: fixed point of 96 bits in three words, least significant first, so that neither order nor
/// grouping changes them.
///
/// A number is first rounded to a multiple of 2^-36, half to even: 1.5e-11, far below the noise of any picture whose
/// values matter. Sums stay exact up to 2^59; numbers beyond 2^50 are cut there.
struct ExactSum {
    static constexpr int fraction_bits = 36;
    static constexpr int words = 3;

    static void add(std::uint32_t* sum, std::int64_t value)
    {
        const std::uint64_t low = sum[0] | std::uint64_t(sum[1]) << 32;
        const std::uint64_t total = low + std::uint64_t(value);
        sum[0] = std::uint32_t(total);
        sum[1] = std::uint32_t(total >> 32);
        sum[2] += std::uint32_t(value >> 63) + (total < low ? 1u : 0u);
    }
    static void add(std::uint32_t* sum, const std::uint32_t* other)
    {
        std::uint64_t carry = 0;
        for (int i = 0; i < words; ++i) {
            carry += std::uint64_t(sum[i]) + other[i];
            sum[i] = std::uint32_t(carry);
            carry >>= 32;
        }
    }
    /// Any finite number.
    static void add_number(std::uint32_t* sum, double value)
    {
        const double cut = std::fmin(std::fmax(value, -0x1p50), 0x1p50);
        const double scaled = std::nearbyint(std::ldexp(cut, fraction_bits));  // below 2^86
        const double upper = std::floor(std::ldexp(scaled, -32));              // exact: below 2^54
        const double lower = scaled - std::ldexp(upper, 32);
        const std::uint32_t number[words] = {std::uint32_t(lower), std::uint32_t(std::int64_t(upper)),
                                             std::uint32_t(std::int64_t(upper) >> 32)};
        add(sum, number);
    }
    static double value(const std::uint32_t* sum)
    {
        // By magnitude: the complement of a small negative number is a large positive one, which a double would round.
        const bool negative = sum[2] >> 31;
        std::uint64_t low = sum[0] | std::uint64_t(sum[1]) << 32;
        std::uint32_t high = sum[2];
        if (negative) {
            low = ~low + 1;
            high = ~high + (low == 0 ? 1 : 0);
        }
        // Factors are powers of two: only the addition, and a lower part beyond 53 bits, are rounded.
        constexpr double unit = 1 / double(std::uint64_t(1) << fraction_bits);
        const double magnitude = double(high) * (0x1p64 * unit) + double(low) * unit;
        return negative ? -magnitude : magnitude;
    }
};

/// Exact sums of squares, which span twice the exponents: fixed point of 128 bits without a sign, least significant
/// word first.
///
/// A square is first rounded to a multiple of 2^-54, half to even: 5.6e-17, so that the variance of radiance from 1e-6
/// on comes out. One beyond 2^64 (radiance of 4e9) is cut there, and sums stop at 2^74: neither depends on the order.
struct ExactSquareSum {
    static constexpr int fraction_bits = 54;
    static constexpr int words = 4;
    using Wide = unsigned __int128;

    static void add(std::uint32_t* sum, Wide value)
    {
        const Wide before = load(sum), total = before + value;
        store(sum, total < before ? ~Wide(0) : total);
    }
    static void add(std::uint32_t* sum, const std::uint32_t* other) { add(sum, load(other)); }
    /// Any number from 0 on.
    static void add_number(std::uint32_t* sum, double square)
    {
        add(sum, Wide(std::nearbyint(std::ldexp(std::fmin(square, 0x1p64), fraction_bits))));
    }
    static double value(const std::uint32_t* sum) { return std::ldexp(double(load(sum)), -fraction_bits); }

private:
    static Wide load(const std::uint32_t* sum)
    {
        Wide value = 0;
        for (int i = words - 1; i >= 0; --i) value = value << 32 | sum[i];
        return value;
    }
    static void store(std::uint32_t* sum, Wide value)
    {
        for (int i = 0; i < words; ++i) sum[i] = std::uint32_t(value >> (32 * i));
    }
};

}  // namespace fathom
