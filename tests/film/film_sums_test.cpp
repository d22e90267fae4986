// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <random>

#include "film/tile_sums.h"

namespace fathom {
namespace {

TEST(ExactSum, DoesNotDependOnOrderOrGrouping)
{
    std::mt19937 random(3);
    std::vector<double> values;
    for (int i = 0; i < 10000; ++i)
        values.push_back(std::ldexp(double(random()) - 2147483648.0, int(random() % 80) - 60));
    std::uint32_t forward[3] = {}, backward[3] = {}, left[3] = {}, right[3] = {};
    for (std::size_t i = 0; i < values.size(); ++i) {
        ExactSum::add_number(forward, values[i]);
        ExactSum::add_number(backward, values[values.size() - 1 - i]);
        ExactSum::add_number(i % 3 ? left : right, values[i]);
    }
    ExactSum::add(left, right);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(forward[i], backward[i]);
        EXPECT_EQ(forward[i], left[i]);
    }
}

TEST(ExactSum, RoundsToItsUnitOnly)
{
    for (double v : {0.0, 1.0, -1.0, 0.1, -0.1, 12345.678, -1e9, 1e14, std::ldexp(1.0, -36), -std::ldexp(1.0, -36)}) {
        std::uint32_t sum[3] = {};
        ExactSum::add_number(sum, v);
        EXPECT_NEAR(ExactSum::value(sum), v, std::ldexp(1.0, -37) + std::abs(v) * 1e-15);
        ExactSum::add_number(sum, -v);
        EXPECT_EQ(ExactSum::value(sum), 0);
    }
}

/// Sums of 64-bit integers carry into the third word in both directions.
TEST(ExactSum, CarriesBeyond64Bits)
{
    std::mt19937_64 random(5);
    std::uint32_t sum[3] = {};
    __extension__ using Wide = __int128;
    Wide expected = 0;
    for (int i = 0; i < 20000; ++i) {
        // The sum grows at first, then falls through zero.
        const auto value = std::int64_t(random() >> 1) * (i < 4000 || i % 3 == 0 ? 1 : -1);
        ExactSum::add(sum, value);
        expected += value;
        for (int word = 0; word < 3; ++word) ASSERT_EQ(sum[word], std::uint32_t(expected >> (32 * word))) << i;
    }
    EXPECT_LT(expected, 0);
    EXPECT_NEAR(ExactSum::value(sum) / (double(expected) * 0x1p-36), 1, 1e-15);
    // The words are those of a sum from another film.
    std::uint32_t a[3] = {0xffffffffu, 0xffffffffu, 1}, one[3] = {1, 0, 0};
    ExactSum::add(a, one);
    EXPECT_EQ(a[0], 0u);
    EXPECT_EQ(a[1], 0u);
    EXPECT_EQ(a[2], 2u);
}

TEST(ExactSquareSum, DoesNotDependOnOrderOrGroupingAndStopsAtItsEnd)
{
    std::mt19937 random(3);
    std::vector<double> values;
    for (int i = 0; i < 10000; ++i) values.push_back(std::ldexp(double(random()), int(random() % 110) - 80));
    for (const double scale : {1.0, 0x1p50}) {  // inside the range of the fast sums, and outside
        std::uint32_t forward[4] = {}, backward[4] = {}, left[4] = {}, right[4] = {};
        double expected = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            ExactSquareSum::add_number(forward, values[i] * scale);
            ExactSquareSum::add_number(backward, values[values.size() - 1 - i] * scale);
            ExactSquareSum::add_number(i % 3 ? left : right, values[i] * scale);
            expected += std::min(values[i] * scale, 0x1p64);
        }
        ExactSquareSum::add(left, right);
        for (int i = 0; i < 4; ++i) {
            EXPECT_EQ(forward[i], backward[i]);
            EXPECT_EQ(forward[i], left[i]);
        }
        EXPECT_NEAR(ExactSquareSum::value(forward) / std::min(expected, 0x1p74), 1, 1e-9);
    }
}

TEST(TileSums, FastAndGeneralPathsAgree)
{
    std::mt19937 random(4);
    TileSums fast;
    fast.reset(1, other_words);
    std::uint32_t film[other_words] = {}, plain[other_words] = {};
    for (int i = 0; i < 1000; ++i) {
        const float v[3] = {float(random() % 1000) * 0.1f, 0.3f * float(i % 7), 1e-7f * float(random() % 100)};
        fast.add(0, 0, v[0], v[1], v[2]);
        for (int c = 0; c < 3; ++c) {
            ExactSum::add_number(radiance_sum(plain, c), v[c]);
            ExactSquareSum::add_number(square_sum(plain, c), double(v[c]) * v[c]);
        }
    }
    fast.add_to(0, film, 0, -1);
    for (int i = 0; i < other_words; ++i) EXPECT_EQ(film[i], plain[i]) << i;
    EXPECT_TRUE(fast.slow().empty());
}

/// Each pixel of a tile has its own sums, also of first-hit layers; ids come from the lowest sample.
TEST(TileSums, PixelsAndFirstHits)
{
    // Other sums follow radiance and squares: depth and hit count, then ids.
    constexpr int sums_of_first_hits = 2, ids = other_words + sums_of_first_hits * ExactSum::words;
    constexpr std::size_t words = ids + 3;
    TileSums sums;
    sums.reset(3, words);
    for (std::uint32_t pixel = 0; pixel < 3; ++pixel) {
        sums.add(pixel, 0, float(pixel) - 0.5f, 2, 127);
        for (int hit = 0; hit < 3; ++hit) {
            sums.add_first_hit(pixel, 0, 1.25f * float(pixel) - 1);
            sums.add_first_hit(pixel, 1, 1);
        }
        sums.add_first_hit(pixel, 0, INFINITY);
        for (std::uint32_t sample : {9u, 4u, 6u}) sums.set_ids(pixel, ids, sample, 10 + sample, 20 + pixel);
    }
    for (std::uint32_t pixel = 0; pixel < 3; ++pixel) {
        std::uint32_t film[words] = {};
        film[ids] = 0xffffffffu;
        sums.add_to(pixel, film, sums_of_first_hits, ids);
        sums.add_to(pixel, film, sums_of_first_hits, ids);
        const double values[] = {double(pixel) - 0.5, 2, 127};
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(ExactSum::value(radiance_sum(film, c)), 2 * values[c], 1e-9) << pixel << " " << c;
            EXPECT_NEAR(ExactSquareSum::value(square_sum(film, c)), 2 * values[c] * values[c], 1e-9)
                << pixel << " " << c;
        }
        EXPECT_NEAR(ExactSum::value(other_sum(film, 0)), 6 * (1.25 * pixel - 1), 1e-9);
        EXPECT_NEAR(ExactSum::value(other_sum(film, 1)), 6, 1e-9);
        EXPECT_EQ(film[ids], 4u);
        EXPECT_EQ(film[ids + 1], 14u);
        EXPECT_EQ(film[ids + 2], 20 + pixel);
    }
    EXPECT_TRUE(sums.slow().empty());
}

TEST(TileSums, BrightSamplesAreKeptApartAndBadOnesCounted)
{
    TileSums sums;
    sums.reset(2, other_words);
    sums.add(1, 5, 1e6f, 0, 0);
    sums.add(1, 7, std::nanf(""), 0, 0);
    sums.add(0, 8, 0, INFINITY, 0);
    ASSERT_EQ(sums.slow().size(), 1u);
    EXPECT_EQ(sums.slow()[0].pixel, 1u);
    EXPECT_EQ(sums.dropped, 2u);
    EXPECT_EQ(sums.first_dropped_pixel, 1u);
    EXPECT_EQ(sums.first_dropped_sample, 7u);
}

}  // namespace
}  // namespace fathom
