// SPDX-License-Identifier: Apache-2.0
#include "difference/flip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "difference/exposures.h"

namespace fathom {
namespace {

using Color3 = std::array<float, 3>;

Colors uniform(const Color3& color, int pixels)
{
    return Colors(std::size_t(pixels), color);
}

/// L* of CIELAB.
double lightness(double luminance)
{
    constexpr double delta = 6.0 / 29;
    const double f =
        luminance > delta * delta * delta ? std::cbrt(luminance) : luminance / (3 * delta * delta) + 4.0 / 29;
    return 116 * f - 16;
}

TEST(Flip, IsZeroForEqualImages)
{
    Colors colors = uniform({0.2f, 0.5f, 0.7f}, 20 * 10);
    colors[57] = {1, 0, 0};
    for (const float value : flip_of_display(colors, colors, 20, 10).map) EXPECT_EQ(value, 0);
    for (const float value : flip_of_radiance(colors, colors, 20, 10).map) EXPECT_EQ(value, 0);
}

TEST(Flip, OfUniformGraysIsTheCompressedDifferenceOfLightness)
{
    // Without edges and chroma, HyAB is the difference of L*. Its largest value is that of green and blue, 203.3 in
    // CIELAB with Hunt's effect.
    constexpr double largest = 203.302;
    for (const auto& [a, b] : {std::pair(0.2f, 0.3f), std::pair(0.0f, 0.05f), std::pair(0.5f, 0.9f)}) {
        const double knee = 0.4 * std::pow(largest, 0.7);
        const double compressed = std::pow(std::abs(lightness(double(a)) - lightness(double(b))), 0.7);
        ASSERT_LT(compressed, knee);
        const Flip flip = flip_of_display(uniform({a, a, a}, 9 * 9), uniform({b, b, b}, 9 * 9), 9, 9);
        EXPECT_NEAR(double(flip.map[40]), compressed * 0.95 / knee, 2e-4) << a << ' ' << b;
        EXPECT_NEAR(double(flip.map[0]), double(flip.map[40]), 1e-4) << "edges of the image repeat the nearest pixel";
    }
}

TEST(Flip, OfGreenAndBlueIsOne)
{
    const Flip flip = flip_of_display(uniform({0, 1, 0}, 64), uniform({0, 0, 1}, 64), 8, 8);
    for (const float value : flip.map) EXPECT_NEAR(value, 1, 1e-4);
}

TEST(Flip, WeighsADifferenceMoreAtAnEdge)
{
    // The largest change is equal: a smooth bump in one image, a sharp line in the other.
    constexpr int side = 64;
    const Colors gray = uniform({0.3f, 0.3f, 0.3f}, side * side);
    Colors line = gray, smooth = gray;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const std::size_t i = std::size_t(y * side + x);
            const float change = 0.2f * std::exp(-float((x - 32) * (x - 32)) / 800);
            for (float& v : smooth[i]) v += change;
            if (x == 32)
                for (float& v : line[i]) v += 0.2f;
        }
    const auto largest = [&](const Colors& image) {
        const Flip flip = flip_of_display(image, gray, side, side);
        return *std::max_element(flip.map.begin(), flip.map.end());
    };
    const Flip of_line = flip_of_display(line, gray, side, side);
    EXPECT_GT(of_line.map[32 * side + 32], 2 * of_line.map[32 * side + 22]);
    EXPECT_GT(largest(line), 0.65f * largest(smooth)) << "by the difference of colors alone, it would be 0.55";
}

TEST(HdrFlip, TakesTheExposuresOfTheReference)
{
    // The curve reaches 0.85 at the x that solves (a x^2 + b x) = 0.85 (c x^2 + d x + e).
    Colors reference = uniform({0.1f, 0.1f, 0.1f}, 100);
    reference[3] = {10, 10, 10};
    const Exposures exposures = exposures_for(reference);
    EXPECT_NEAR(exposures.last - exposures.first, std::log2(100.0), 1e-5);
    EXPECT_EQ(exposures.count, 7);
    const Colors shown = tone_mapped(reference, exposures.first);
    EXPECT_NEAR(shown[3][0], 0.85f, 1e-4f);
    EXPECT_NEAR(tone_mapped(reference, exposures.last)[0][1], 0.85f, 1e-4f);
}

TEST(HdrFlip, SeesDifferencesInDarkAndBrightAreas)
{
    Colors reference = uniform({0.01f, 0.01f, 0.01f}, 40 * 40);
    for (int i = 0; i < 200; ++i) reference[std::size_t(i)] = {50, 50, 50};
    Colors dark = reference, bright = reference;
    for (int i = 1200; i < 1600; ++i) dark[std::size_t(i)] = {0.015f, 0.015f, 0.015f};
    for (int i = 0; i < 200; ++i) bright[std::size_t(i)] = {75, 75, 75};
    EXPECT_GT(flip_of_radiance(dark, reference, 40, 40).map[1500], 0.1f);
    EXPECT_GT(flip_of_radiance(bright, reference, 40, 40).map[20], 0.05f);
    EXPECT_LT(flip_of_radiance(bright, reference, 40, 40).map[1500], 0.01f);
}

TEST(HdrFlip, OfABlackReferenceIsFinite)
{
    const Flip flip = flip_of_radiance(uniform({1, 1, 1}, 64), uniform({0, 0, 0}, 64), 8, 8);
    for (const float value : flip.map) EXPECT_TRUE(value > 0.5f && value <= 1) << value;
}

}  // namespace
}  // namespace fathom
