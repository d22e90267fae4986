// SPDX-License-Identifier: Apache-2.0
#include "fathom/noise_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "difference/made_images.h"

namespace fathom {
namespace {

/// A render without a renderer: samples are 0 or 1 / chance, with the mean 1.
struct Synthetic {
    int width = 64, height = 48, samples = 16;
    double chance = 0.25;
    std::uint32_t seed = 1;

    /// factor  the mean of a pixel's red
    template <class Factor>
    Image image(const Factor& factor) const
    {
        Image image = test::uniform_image(width, height, {"R", "G", "B"}, {0, 0, 0}, true);
        image.layers.push_back({"variance", {"R", "G", "B"}, image.layers[0].pixels});
        image.attributes["fathom.samples_per_pixel"] = std::to_string(samples);
        std::mt19937 random(seed);
        std::binomial_distribution<int> hits(samples, chance);
        for (std::size_t i = 0; i < image.layers[0].pixels.size(); ++i) {
            const int x = int(i / 3) % width, y = int(i / 3) / width;
            const double scale = (i % 3 == 0 ? factor(x, y) : 1) / chance;
            const double p = double(hits(random)) / samples;
            image.layers[0].pixels[i] = float(scale * p);
            image.layers[1].pixels[i] = float(scale * scale * p * (1 - p) / (samples - 1));
        }
        return image;
    }
    Image image() const
    {
        return image([](int, int) { return 1.0; });
    }
};

Synthetic with_seed(std::uint32_t seed, int samples = 16, double chance = 0.25)
{
    Synthetic synthetic;
    synthetic.seed = seed, synthetic.samples = samples, synthetic.chance = chance;
    return synthetic;
}

TEST(NoiseTest, TakesNoiseForNoise)
{
    int found = 0;
    for (std::uint32_t i = 0; i < 100; ++i)
        found += test_noise(with_seed(2 * i).image(), with_seed(2 * i + 1, 4 << (i % 4)).image()).is_noise() ? 0 : 1;
    EXPECT_LE(found, 3) << "1 % is the limit of the probability";
}

TEST(NoiseTest, TakesRareBrightSamplesForNoise)
{
    // Most pixels with two samples have seen none of the light.
    for (std::uint32_t i = 0; i < 20; ++i)
        EXPECT_TRUE(test_noise(with_seed(2 * i, 2, 0.01).image(), with_seed(2 * i + 1, 256, 0.01).image()).is_noise());
}

TEST(NoiseTest, HasTheSizeOfTheTestItNames)
{
    // The smallest of the corrected p is below 0.3 in 26 % of cases if p is uniform and tests are independent. Taking
    // the larger variance of both images makes it rarer.
    int below = 0;
    constexpr int runs = 200;
    for (std::uint32_t i = 0; i < runs; ++i)
        below += test_noise(with_seed(2 * i, 256).image(), with_seed(2 * i + 1, 256).image()).smallest_p < 0.3 ? 1 : 0;
    EXPECT_GT(below, 0.08 * runs);
    EXPECT_LT(below, 0.34 * runs);
}

TEST(NoiseTest, FindsTheBlockThatChanged)
{
    const Image changed =
        with_seed(1, 64).image([](int x, int y) { return x >= 32 && x < 48 && y >= 16 && y < 32 ? 1.3 : 1.0; });
    const NoiseTest test = test_noise(changed, with_seed(2, 256).image());
    ASSERT_EQ(test.changes.size(), 1u);
    const NoiseTest::Change& change = test.changes[0];
    EXPECT_EQ(change.x0, 32);
    EXPECT_EQ(change.y0, 16);
    EXPECT_EQ(change.x1, 48);
    EXPECT_EQ(change.y1, 32);
    EXPECT_EQ(change.channel, "R");
    EXPECT_NEAR(change.mean, 1.3, 0.1);
    EXPECT_NEAR(change.reference_mean, 1, 0.05);
    // Samples of a and b have the variance 3 in 256 pixels; 1.3^2 times as much in the changed ones.
    const double expected = std::sqrt(3 * 1.69 / 64 / 256 + 3 * 1.69 / 256 / 256);
    EXPECT_NEAR(change.standard_error, expected, 0.1 * expected);
    EXPECT_LT(change.p, 0.01);
    EXPECT_FALSE(test.is_noise());
    EXPECT_EQ(test.blocks, 12u);
}

TEST(NoiseTest, FindsASmallChangeOfTheWholeImage)
{
    const NoiseTest test = test_noise(with_seed(1, 64).image([](int, int) { return 1.03; }), with_seed(2, 64).image());
    EXPECT_TRUE(test.whole_changed);
    EXPECT_TRUE(test.changes.empty()) << "no block alone shows it";
}

TEST(NoiseTest, FindsChangesWithoutNoise)
{
    Image a = with_seed(1).image();
    for (float& variance : a.layers[1].pixels) variance = 0;
    Image b = a;
    EXPECT_TRUE(test_noise(a, b).is_noise());
    b.layers[0].pixels[0] += 1;
    const NoiseTest test = test_noise(a, b);
    ASSERT_EQ(test.changes.size(), 1u);
    EXPECT_EQ(test.changes[0].p, 0);
}

TEST(NoiseTest, LeavesOutTheRoundingOfHalf)
{
    // Both images have one flat color, stored as float in one and as half in the other.
    Image exact = test::uniform_image(32, 32, {"R", "G", "B"}, {0.1f, 0.1f, 0.1f}, true);
    exact.layers.push_back({"variance", {"R", "G", "B"}, std::vector<float>(3 * 32 * 32)});
    exact.attributes["fathom.samples_per_pixel"] = "4";
    Image half = exact;
    for (float& value : half.layers[0].pixels) value = 0.0999755859375f;
    EXPECT_TRUE(test_noise(exact, half).is_noise());
    for (float& value : half.layers[0].pixels) value = 0.10009765625f;
    EXPECT_FALSE(test_noise(exact, half).is_noise());
}

TEST(NoiseTest, SaysWhatIsMissing)
{
    Image image = with_seed(1).image();
    EXPECT_EQ(noise_test_obstacle(image), "");
    image.attributes.clear();
    EXPECT_EQ(noise_test_obstacle(image), "does not state that it has two samples per pixel or more");
    image.layers.push_back({"samples", {"Y"}, std::vector<float>(64 * 48, 16)});
    EXPECT_EQ(noise_test_obstacle(image), "");
    image.layers.erase(image.layers.begin() + 1);
    EXPECT_EQ(noise_test_obstacle(image), "has no layer variance");
    image.layers[0].channels = {"X", "Y", "Z"};
    EXPECT_EQ(noise_test_obstacle(image), "has no red, green and blue");
}

}  // namespace
}  // namespace fathom
