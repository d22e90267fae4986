// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstdint>

namespace fathom {

/// Exact sums of signed numbers in 96-bit fixed point: three words, least significant first. Neither the order nor the
/// grouping of the terms changes the result.
///
/// A number is first rounded to a multiple of 2^-36, half to even: 1.5e-11, far below the noise of any image. Numbers
/// beyond 2^50 in magnitude are clamped; sums stay exact up to 2^59.
struct ExactSum {
    static constexpr int fraction_bits = 36;
    static constexpr int words = 3;

    /// Adds a number given in units of 2^-36.
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
    /// Adds any finite number, after rounding and clamping.
    static void add_number(std::uint32_t* sum, double value)
    {
        if (std::fabs(value) < 0x1p26) return add(sum, std::llrint(value * double(std::uint64_t(1) << fraction_bits)));
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
        // The magnitude is converted because the two's complement of a small negative number is large: a double would
        // round it.
        const bool negative = sum[2] >> 31;
        std::uint64_t low = sum[0] | std::uint64_t(sum[1]) << 32;
        std::uint32_t high = sum[2];
        if (negative) {
            low = ~low + 1;
            high = ~high + (low == 0 ? 1 : 0);
        }
        // The factors are powers of two, so only the addition and a low part beyond 53 bits are rounded.
        constexpr double unit = 1 / double(std::uint64_t(1) << fraction_bits);
        const double magnitude = double(high) * (0x1p64 * unit) + double(low) * unit;
        return negative ? -magnitude : magnitude;
    }
};

/// Exact sums of squares in unsigned 128-bit fixed point, least significant word first; squares span twice the exponent
/// range.
///
/// A square is first rounded to a multiple of 2^-54, half to even: 5.6e-17, enough for the variance of radiance from
/// 1e-6 on. Squares beyond 2^64 (radiance 4e9) are clamped, and sums saturate at 2^74; neither depends on the order.
struct ExactSquareSum {
    static constexpr int fraction_bits = 54;
    static constexpr int words = 4;
    using Wide = unsigned __int128;

    /// Adds a square given in units of 2^-54.
    static void add(std::uint32_t* sum, Wide value)
    {
        const Wide before = load(sum), total = before + value;
        store(sum, total < before ? ~Wide(0) : total);
    }
    static void add(std::uint32_t* sum, const std::uint32_t* other) { add(sum, load(other)); }
    /// Adds any number >= 0, after rounding and clamping.
    static void add_number(std::uint32_t* sum, double square)
    {
        if (square < 0x1p8) return add(sum, Wide(std::llrint(square * double(std::uint64_t(1) << fraction_bits))));
        add(sum, Wide(std::nearbyint(std::ldexp(std::fmin(square, 0x1p64), fraction_bits))));
    }
    /// The sum as a double, rounded.
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
