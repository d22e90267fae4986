// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "sampling/filter.h"
#include "sampling/warp.h"
#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

Sample2 sobol_point(std::uint32_t pixel, std::uint32_t index, std::uint32_t group, std::uint32_t pair)
{
    const SampleKey key{hash(UInt(pixel)), reverse_bits(UInt(index))};
    return sample_2d(key, pair_seed(group_seed(key, UInt(group)), pair));
}

TEST(Sobol, EveryElementaryIntervalHoldsOnePoint)
{
    // In a (0, 2)-sequence each elementary interval of area 2^-m contains one of the first 2^m points, and one of each
    // later block of 2^m.
    for (std::uint32_t pixel : {0u, 7u})
        for (std::uint32_t pair : {0u, 1u, 3u})
            for (int m : {4, 8})
                for (std::uint32_t block : {0u, 5u}) {
                    const std::uint32_t n = 1u << m;
                    std::vector<std::pair<float, float>> points;
                    for (std::uint32_t i = 0; i < n; ++i) {
                        const Sample2 s = sobol_point(pixel, block * n + i, 2, pair);
                        points.emplace_back(first(s.x), first(s.y));
                    }
                    for (int kx = 0; kx <= m; ++kx) {
                        std::set<std::pair<int, int>> cells;
                        for (auto [x, y] : points) cells.emplace(int(std::ldexp(x, kx)), int(std::ldexp(y, m - kx)));
                        EXPECT_EQ(cells.size(), n) << "pixel " << pixel << " pair " << pair << " 2^" << kx;
                    }
                }
}

TEST(Sobol, PairsAndPixelsAreIndependent)
{
    // Different pairs, decisions and pixels are uncorrelated at equal sample index.
    constexpr int n = 1 << 14;
    const auto correlation = [&](auto a, auto b) {
        double sum = 0;
        for (std::uint32_t i = 0; i < n; ++i) sum += (a(i) - 0.5) * (b(i) - 0.5);
        return 12 * sum / n;
    };
    const auto base = [](std::uint32_t i) { return double(first(sobol_point(3, i, 1, 0).x)); };
    const double limit = 5 / std::sqrt(double(n));
    EXPECT_LT(std::abs(correlation(base, [](std::uint32_t i) { return double(first(sobol_point(3, i, 1, 1).x)); })),
              limit);
    EXPECT_LT(std::abs(correlation(base, [](std::uint32_t i) { return double(first(sobol_point(3, i, 2, 0).x)); })),
              limit);
    EXPECT_LT(std::abs(correlation(base, [](std::uint32_t i) { return double(first(sobol_point(4, i, 1, 0).x)); })),
              limit);
    EXPECT_LT(std::abs(correlation(base, [](std::uint32_t i) { return double(first(sobol_point(3, i, 1, 0).y)); })),
              limit);
}

/// The unscrambled dimensions are the van der Corput sequence, and the dimension whose generator matrix is Pascal's
/// triangle modulo 2.
TEST(Sobol, DimensionsAreTheDirectionNumbers)
{
    for (std::uint32_t i = 0; i < 1000; ++i) {
        std::uint32_t expected = 0;
        for (std::uint32_t k = 0; k < 32; ++k)
            for (std::uint32_t j = k; j < 32; ++j)
                // The binomial coefficient (j over k) is odd if k's bits are a subset of j's (Lucas).
                if (i >> j & 1 && (k & j) == k) expected ^= 1u << k;
        EXPECT_EQ(first(sobol1_reversed(UInt(i))), expected) << i;
    }
}

TEST(Sobol, IntegratesSmoothFunctionsMuchBetterThanChance)
{
    // With Owen scrambling the variance for smooth integrands decreases as n^-3, that of independent numbers as n^-1.
    const auto variance = [](std::uint32_t n) {
        double sum = 0;
        constexpr int runs = 256;
        for (std::uint32_t pixel = 0; pixel < runs; ++pixel) {
            double mean = 0;
            for (std::uint32_t i = 0; i < n; ++i) {
                const Sample2 s = sobol_point(pixel, i, 1, 0);
                mean += double(first(s.x)) * double(first(s.x)) * double(first(s.y));
            }
            sum += (mean / n - 1.0 / 6) * (mean / n - 1.0 / 6);
        }
        return sum / runs;
    };
    const double chance = (1.0 / 5 / 3 - 1.0 / 36) / 256;
    EXPECT_LT(variance(256), chance / 100);
    EXPECT_LT(variance(256), variance(64) / 20);
}

TEST(Warp, CosineHemisphere)
{
    test::Random random;
    std::vector<test::Direction> samples;
    while (samples.size() < 100000) {
        const Vec3 w = sample_cosine_hemisphere(random.next2());
        float x[lanes], y[lanes], z[lanes];
        store(x, w.x), store(y, w.y), store(z, w.z);
        for (int i = 0; i < lanes; ++i) samples.push_back({x[i], y[i], z[i]});
    }
    EXPECT_EQ(
        test::chi_square_directions(samples, [](test::Direction d) { return std::max(0.0, d.z) / std::numbers::pi; }),
        "");
}

/// The histogram has cells of equal probability in cosine and azimuth; the cosine alone would not test sine and
/// azimuth.
TEST(Warp, ConeIsUniformInBothAngles)
{
    for (double one_minus_cos : {1e-4, 0.3, 1.7, 2.0}) {
        constexpr int rings = 12, sectors = 16;
        std::vector<double> observed(rings * sectors), expected(rings * sectors);
        test::Random random;
        int drawn = 0;
        for (; drawn < 100000; drawn += lanes) {
            const Vec3 w = sample_cone(random.next2(), Float(float(one_minus_cos)));
            float x[lanes], y[lanes], z[lanes];
            store(x, w.x), store(y, w.y), store(z, w.z);
            for (int i = 0; i < lanes; ++i) {
                const double sine2 = double(x[i]) * x[i] + double(y[i]) * y[i];
                ASSERT_NEAR(sine2 + double(z[i]) * z[i], 1, 2e-6);
                // 1 - cos is computed from the sine, because floats lack digits when the cosine is near 1.
                const double lost = z[i] > 0 ? sine2 / (1 + double(z[i])) : 1 - double(z[i]);
                ASSERT_LE(lost, one_minus_cos * (1 + 1e-5));
                const double turn = std::atan2(y[i], x[i]) / (2 * std::numbers::pi) + 0.5;
                ++observed[std::size_t(std::min(rings - 1, int(lost / one_minus_cos * rings)) * sectors +
                                       std::min(sectors - 1, int(turn * sectors)))];
            }
        }
        for (double& e : expected) e = double(drawn) / (rings * sectors);
        EXPECT_EQ(test::chi_square(observed, expected), "") << one_minus_cos;
    }
}

TEST(Warp, PowerHeuristic)
{
    for (double a : {1e-3, 0.5, 1.0, 7.0, 1e4})
        for (double b : {1e-3, 0.5, 1.0, 7.0, 1e4}) {
            const double weight = first(mis_weight(Float(float(a)), Float(float(b))));
            EXPECT_NEAR(weight, a * a / (a * a + b * b), 1e-6) << a << " " << b;
        }
    EXPECT_FLOAT_EQ(first(mis_weight(Float(1e30f), Float(1))), 1);
}

TEST(Warp, DiskIsUniform)
{
    test::Random random;
    // The sectors are finer than the octants of the mapping, which might be uneven inside.
    constexpr int rings = 8, sectors = 40;
    std::vector<double> observed(rings * sectors), expected(rings * sectors);
    constexpr int n = 100000;
    int drawn = 0;
    for (; drawn < n; drawn += lanes) {
        const DiskPoint p = sample_disk(random.next2());
        float x[lanes], y[lanes];
        store(x, p.x), store(y, p.y);
        for (int i = 0; i < lanes; ++i) {
            const double r2 = double(x[i]) * x[i] + double(y[i]) * y[i];
            ASSERT_LE(r2, 1 + 1e-6);
            const double turn = std::atan2(y[i], x[i]) / (2 * std::numbers::pi) + 0.5;
            ++observed[std::size_t(std::min(rings - 1, int(r2 * rings)) * sectors +
                                   std::min(sectors - 1, int(turn * sectors)))];
        }
    }
    for (double& e : expected) e = double(drawn) / (rings * sectors);
    EXPECT_EQ(test::chi_square(observed, expected), "");
}

TEST(Filter, FollowsItsShape)
{
    FilterTable gaussian, blackman_harris, tent;
    gaussian.make_gaussian();
    blackman_harris.make_blackman_harris();
    tent.make_tent();
    const auto check = [](const FilterTable& table, double radius, auto f) {
        constexpr int cells = 40, per_cell = 2000;
        std::vector<double> observed(cells), expected(cells);
        double total = 0;
        for (int i = 0; i < cells; ++i) {
            for (int k = 0; k < 50; ++k) expected[std::size_t(i)] += f(radius * (2 * (i + (k + 0.5) / 50) / cells - 1));
            total += expected[std::size_t(i)];
        }
        test::Random random;
        int drawn = 0;
        for (; drawn < cells * per_cell; drawn += lanes) {
            float x[lanes];
            store(x, table.sample(random.next()));
            for (float v : x) {
                ASSERT_LE(std::abs(v), radius + 1e-5);
                ++observed[std::size_t(std::clamp(int((v / radius + 1) / 2 * cells), 0, cells - 1))];
            }
        }
        for (double& e : expected) e *= drawn / total;
        EXPECT_EQ(test::chi_square(observed, expected), "");
    };
    check(tent, 1, [](double x) { return 1 - std::abs(x); });
    check(gaussian, 2, [](double x) { return std::exp(-2 * x * x) - std::exp(-8.0); });
    check(blackman_harris, 1.65, [](double x) {
        const double t = std::numbers::pi * (x / 1.65 + 1);
        return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
    });
}

/// The window is that of Harris 1978, "On the Use of Windows for Harmonic Analysis", minimum 4-term: its closed-form
/// integral up to each sampled offset is the random number. An error of 0.001 in a coefficient is detected.
TEST(Filter, BlackmanHarrisToTheLastCoefficient)
{
    FilterTable table;
    table.make_blackman_harris();
    const auto share_below = [](double x) {
        const double t = std::numbers::pi * (x / 1.65 + 1);
        const double integral =
            0.35875 * t - 0.48829 * std::sin(t) + 0.14128 / 2 * std::sin(2 * t) - 0.01168 / 3 * std::sin(3 * t);
        return integral / (0.35875 * 2 * std::numbers::pi);
    };
    for (double u = 0.02; u < 1; u += 0.02)
        EXPECT_NEAR(share_below(double(first(table.sample(Float(float(u)))))), u, 2e-5) << u;
}

/// The integral of a filter up to the sampled offset is the random number, also at the filter's ends, where few samples
/// fall.
TEST(Filter, IsTheInverseOfItsShares)
{
    FilterTable gaussian, blackman_harris, tent;
    gaussian.make_gaussian();
    blackman_harris.make_blackman_harris();
    tent.make_tent();
    const auto check = [](const FilterTable& table, double radius, auto f) {
        const auto share_below = [&](double x) {
            double below = 0, all = 0;
            constexpr int steps = 20000;
            for (int i = 0; i < steps; ++i) {
                const double at = radius * (2 * (i + 0.5) / steps - 1);
                all += f(at);
                if (at < x) below += f(at);
            }
            return below / all;
        };
        for (double u : {1e-6, 1e-4, 1e-3, 0.01, 0.1, 0.3, 0.499, 0.6, 0.9, 0.999, 0.9999})
            EXPECT_NEAR(share_below(double(first(table.sample(Float(float(u)))))), u, 2e-4 + 0.05 * std::min(u, 1 - u))
                << u;
        EXPECT_NEAR(first(table.sample(Float(0))), -radius, 1e-3);
        EXPECT_NEAR(first(table.sample(Float(1 - 0x1p-24f))), radius, 0.1);
        EXPECT_NEAR(first(table.sample(Float(0.5f))), 0, 1e-3);
    };
    check(tent, 1, [](double x) { return 1 - std::abs(x); });
    check(gaussian, 2, [](double x) { return std::exp(-2 * x * x) - std::exp(-8.0); });
    check(blackman_harris, 1.65, [](double x) {
        const double t = std::numbers::pi * (x / 1.65 + 1);
        return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
    });
}

}  // namespace
}  // namespace fathom
