// SPDX-License-Identifier: Apache-2.0
#include "session/variance_estimate.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

/// The variance of evenly spread groups is that of their means, not of the samples in them.
TEST(VarianceEstimate, VariancesOfPixels)
{
    // The sets have means of 2, 2, 3 and 5, 2, 1.
    const std::vector<PixelVariance> pairs = pixel_variances({{1, 3, 2, 2, 0, 6}, {4, 6, 0, 4, 1, 1}}, 2);
    ASSERT_EQ(pairs.size(), 3u);
    const double means[] = {3.5, 2, 2}, variances[] = {9, 0, 4};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_DOUBLE_EQ(pairs[i].mean, means[i]) << i;
        EXPECT_DOUBLE_EQ(pairs[i].variance, variances[i]) << i;
    }
    const std::vector<PixelVariance> fours = pixel_variances({{1, 2, 3, 6}, {0, 0, 0, 20}, {6, 4, 8, 10}}, 4);
    ASSERT_EQ(fours.size(), 1u);
    EXPECT_DOUBLE_EQ(fours[0].mean, 5);
    EXPECT_DOUBLE_EQ(fours[0].variance, 4 * (4 + 0 + 4) / 2.0);
}

/// A pixel's brightness is averaged over up to sixteen neighbors on either side, plus a part of the image's mean.
TEST(VarianceEstimate, BrightnessIsAveragedOverNeighbors)
{
    std::vector<PixelVariance> pixels(40);
    pixels[20].mean = 33;
    const std::vector<double> squares = squared_brightness(pixels);
    ASSERT_EQ(squares.size(), 40u);
    const double of_mean = 0.1 * (33.0 / 40) * (33.0 / 40);
    for (std::size_t i = 0; i < 40; ++i) {
        double around = 0;
        if (i >= 4 && i < 16) around = 33.0 / double(i + 17);
        if (i >= 16 && i < 24) around = 1;
        if (i >= 24 && i <= 36) around = 33.0 / double(56 - i);
        EXPECT_NEAR(squares[i], around * around + of_mean, 1e-12) << i;
    }
    EXPECT_DOUBLE_EQ(squared_brightness({{3, 1}})[0], 9.9);
}

/// The largest of a thousand numbers is ignored.
TEST(VarianceEstimate, MeanWithoutOutliers)
{
    EXPECT_EQ(mean_without_outliers({3}), 3);
    EXPECT_DOUBLE_EQ(mean_without_outliers({1, 6, 2}), 3);
    std::vector<double> numbers(1000, 1.0);
    numbers[567] = 1e9;
    EXPECT_EQ(mean_without_outliers(numbers), 1);
    numbers[3] = 1000;
    EXPECT_DOUBLE_EQ(mean_without_outliers(numbers), 2);
    numbers.pop_back();
    numbers[567] = 1;
    EXPECT_DOUBLE_EQ(mean_without_outliers(numbers), 1998.0 / 999);
    numbers.assign(2000, 1.0);
    numbers[0] = numbers[1999] = 1e9, numbers[1] = 1999;
    EXPECT_DOUBLE_EQ(mean_without_outliers(numbers), 2);
}

}  // namespace
}  // namespace fathom
