// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/elementary.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

TEST(Lanes, EachOperationMatchesPlainArithmetic)
{
    test::Random random;
    for (int n = 0; n < 200; ++n) {
        const Float a = random.next() * Float(8) - Float(4), b = random.next() * Float(8) - Float(4), c = random.next();
        float x[lanes], y[lanes], z[lanes], r[lanes];
        store(x, a), store(y, b), store(z, c);
        const auto check = [&](Float result, auto plain) {
            store(r, result);
            for (int i = 0; i < lanes; ++i) EXPECT_EQ(r[i], plain(x[i], y[i], z[i]));
        };
        check(a + b, [](float p, float q, float) { return p + q; });
        check(a - b, [](float p, float q, float) { return p - q; });
        check(a * b, [](float p, float q, float) { return p * q; });
        check(a / b, [](float p, float q, float) { return p / q; });
        check(-a, [](float p, float, float) { return -p; });
        check(fma(a, b, c), [](float p, float q, float s) { return std::fma(p, q, s); });
        check(sqrt(abs(a)), [](float p, float, float) { return std::sqrt(std::fabs(p)); });
        check(floor(a), [](float p, float, float) { return std::floor(p); });
        check(min(a, b), [](float p, float q, float) { return p < q ? p : q; });
        check(max(a, b), [](float p, float q, float) { return p > q ? p : q; });
        check(copysign(a, b), [](float p, float q, float) { return std::copysign(p, q); });
        check(flip_sign(a, b), [](float p, float q, float) { return std::signbit(q) ? -p : p; });
        check(select(a < b, a, c), [](float p, float q, float s) { return p < q ? p : s; });
        check(to_float(to_uint(a)), [](float p, float, float) { return float(int(p)); });
    }
}

TEST(Lanes, MinAndMaxOfNanAreTheSecondArgument)
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(first(min(Float(nan), Float(1))), 1);
    EXPECT_EQ(first(max(Float(nan), Float(1))), 1);
    EXPECT_TRUE(std::isnan(first(min(Float(1), Float(nan)))));
}

TEST(Lanes, LeastOfEach)
{
    test::Random random;
    for (int n = 0; n < 50; ++n) {
        Float x[16];
        float out[16];
        for (Float& a : x) a = random.next() - Float(0.5f);
        reduce_min_each(x, out);
        for (int i = 0; i < 16; ++i) {
            float y[lanes];
            store(y, x[i]);
            EXPECT_EQ(out[i], *std::min_element(y, y + lanes));
            EXPECT_EQ(least(x[i]), out[i]);
        }
    }
}

TEST(Lanes, RunningSums)
{
    test::Random random;
    for (int n = 0; n < 50; ++n) {
        std::uint32_t x[native::lanes], sums[native::lanes], sum = 0;
        for (std::uint32_t& a : x) a = std::uint32_t(first(random.next()) * 65536);
        native::store(sums, native::prefix_sums(native::load(x)));
        for (int i = 0; i < native::lanes; ++i) EXPECT_EQ(sums[i], sum += x[i]) << i;
    }
}

TEST(Lanes, CompressGatherAndReverse)
{
    float table[64];
    for (int i = 0; i < 64; ++i) table[i] = float(i) * 1.5f;
    for (std::uint32_t bits : {0u, 1u, 0x55555555u, 0xfffffffeu, 0x8001u, 0xf0f0f0f0u, 0xffffffffu}) {
        const Mask m = mask_from_bits(bits) & first_lanes(lanes);
        std::uint32_t packed[2 * lanes + 32];
        compress_store(packed, iota() + UInt(100u), m);
        int n = 0;
        for (int i = 0; i < lanes; ++i)
            if (mask_bits(m) >> i & 1) {
                EXPECT_EQ(packed[n++], std::uint32_t(100 + i));
            }
        EXPECT_EQ(n, count(m));
        float g[lanes];
        store(g, gather(table, iota(), m));
        for (int i = 0; i < lanes; ++i) EXPECT_EQ(g[i], mask_bits(m) >> i & 1 ? table[i] : 0);
    }
    for (std::uint32_t v : {0u, 1u, 0x12345678u, 0xdeadbeefu, 0x80000000u}) {
        std::uint32_t expected = 0;
        for (int i = 0; i < 32; ++i) expected |= (v >> i & 1) << (31 - i);
        EXPECT_EQ(first(reverse_bits(UInt(v))), expected);
        EXPECT_EQ(first(rotate16(UInt(v))), v >> 16 | v << 16);
    }
    for (int n : {3, 8, 9, 16, 17, 32})
        for (std::uint32_t i = 0; i < std::uint32_t(n); ++i) EXPECT_EQ(first(lookup(table, n, UInt(i))), table[i]);
}

/// Expects that each lane gathers its own rows, up to the last one, which ends with its table.
template <int n>
void expect_rows()
{
    constexpr std::uint32_t rows = 41;
    std::vector<float> table(rows * n);
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = float(i) + 0.5f;
    for (std::uint32_t turn = 0; turn < rows; ++turn)
        for (std::uint32_t bits : {0u, 0x55555555u, 0xfffffffeu, 0x8001u, 0xffffffffu}) {
            const Mask m = mask_from_bits(bits) & first_lanes(lanes);
            std::uint32_t at[lanes];
            for (std::uint32_t i = 0; i < lanes; ++i) at[i] = (i * 7 + turn) % rows * n;
            Float row[n];
            gather_row(table.data(), load(at), m, row);
            for (int k = 0; k < n; ++k) {
                float x[lanes];
                store(x, row[k]);
                for (int i = 0; i < lanes; ++i)
                    ASSERT_EQ(x[i], mask_bits(m) >> i & 1 ? table[at[i] + std::uint32_t(k)] : 0) << n << " " << k;
            }
        }
}
TEST(Lanes, RowsAreGatheredWhole)
{
    expect_rows<2>(), expect_rows<3>(), expect_rows<4>(), expect_rows<8>(), expect_rows<12>();
}

TEST(Elementary, ErrorsStayBelowWhatIsPromised)
{
    double sine = 0, arc = 0, ex = 0, lg = 0, rs = 0, rc = 0;
    for (int i = 0; i < 200000; ++i) {
        const double x = (i - 100000) * 1e-4;
        const SinCos s = sincos_2pi(Float(float(x)));
        sine = std::max({sine, std::abs(first(s.sin) - std::sin(2 * std::numbers::pi * double(float(x)))),
                         std::abs(first(s.cos) - std::cos(2 * std::numbers::pi * double(float(x))))});
        const float y = float(std::sin(i * 0.37)), z = float(std::cos(i * 0.73));
        arc = std::max(arc, std::abs(first(atan2(Float(y), Float(z))) - std::atan2(double(y), double(z))));
        const float e = float(x * 8);
        ex = std::max(ex, std::abs(first(exp2(Float(e))) / std::exp2(double(e)) - 1));
        const float positive = float(std::exp(x * 8));
        lg = std::max(lg, std::abs(first(log2(Float(positive))) - std::log2(double(positive))) /
                              std::max(1.0, std::abs(std::log2(double(positive)))));
        rs = std::max(rs, std::abs(first(inverse_sqrt(Float(positive))) * std::sqrt(double(positive)) - 1));
        rc = std::max(rc, std::abs(first(reciprocal(Float(positive))) * double(positive) - 1));
    }
    EXPECT_LT(sine, 1.5e-7);
    EXPECT_LT(arc, 4e-7);
    EXPECT_LT(ex, 2e-7);
    EXPECT_LT(lg, 3e-7);
    EXPECT_LT(rs, 2.4e-7);
    EXPECT_LT(rc, 2.4e-7);
    EXPECT_EQ(first(Float(0) * inverse_sqrt(Float(0))), 0);
    EXPECT_EQ(first(atan2(Float(0), Float(0))), 0);
    EXPECT_EQ(first(exp2(Float(-200))), 0);
    EXPECT_TRUE(std::isinf(first(exp2(Float(200)))));
}

TEST(Frame, IsOrthonormalForAnyNormal)
{
    test::Random random;
    for (int i = 0; i < 1000; ++i) {
        const Vec3 n =
            normalize(Vec3{random.next() - Float(0.5f), random.next() - Float(0.5f), random.next() - Float(0.5f)});
        const Frame f(n);
        EXPECT_NEAR(first(dot(f.s, f.t)), 0, 1e-6);
        EXPECT_NEAR(first(dot(f.s, f.n)), 0, 1e-6);
        EXPECT_NEAR(first(dot(f.t, f.t)), 1, 2e-6);
        EXPECT_NEAR(first(dot(cross(f.s, f.t), f.n)), 1, 2e-6);
    }
    const Frame down(Vec3{Float(0), Float(0), Float(-1)});
    EXPECT_NEAR(first(dot(cross(down.s, down.t), down.n)), 1, 1e-6);
}

}  // namespace
}  // namespace fathom
