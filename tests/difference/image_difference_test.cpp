// SPDX-License-Identifier: Apache-2.0
#include "fathom/image_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "difference/made_images.h"
#include "fathom/error.h"

namespace fathom {
namespace {

using test::uniform_image;

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

ImageDifference difference(const Image& a, const Image& b, const CompareOptions& options = {})
{
    return compare_images(a, "a.exr", b, "b.exr", options);
}

std::string message(const Image& a, const Image& b, const CompareOptions& options = {})
{
    try {
        difference(a, b, options);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

Image radiance(const std::vector<float>& values)
{
    return uniform_image(4, 3, {"R", "G", "B"}, values, true);
}

TEST(ImageDifference, OfEqualImagesIsZero)
{
    const ImageDifference d = difference(radiance({1, 2, 3}), radiance({1, 2, 3}));
    EXPECT_TRUE(d.is_same());
    EXPECT_EQ(d.largest.difference, 0);
    EXPECT_EQ(d.color->mse, 0);
    EXPECT_EQ(d.color->psnr_db, std::nullopt);
    EXPECT_EQ(d.color->relmse, 0);
    EXPECT_EQ(d.color->flip.mean, 0);
}

TEST(ImageDifference, FindsTheLargestDifferenceAndCountsPixels)
{
    Image a = radiance({1, 2, 3});
    a.layers[0].pixels[3 * 5 + 1] += 0.5f;    // pixel 1,1
    a.layers[0].pixels[3 * 11 + 2] -= 0.75f;  // pixel 3,2
    const ImageDifference d = difference(a, radiance({1, 2, 3}));
    EXPECT_EQ(d.different_pixels, 2u);
    EXPECT_EQ(d.largest.difference, 0.75);
    EXPECT_EQ(d.largest.x, 3);
    EXPECT_EQ(d.largest.y, 2);
    EXPECT_EQ(d.largest.channel, "B");
    EXPECT_EQ(d.largest.value, 2.25f);
    EXPECT_EQ(d.largest.reference, 3.0f);
    EXPECT_EQ(d.differences[5], 0.5f);
}

TEST(ImageDifference, ToleratesUpToTheTolerance)
{
    const Image a = radiance({1, 1, 1.25f}), b = radiance({1, 1, 1});
    EXPECT_TRUE(difference(a, b, {"", 0.25}).is_same());
    EXPECT_FALSE(difference(a, b, {"", 0.2499}).is_same());
    EXPECT_EQ(difference(a, b, {"", 0.25}).largest.difference, 0.25);
}

TEST(ImageDifference, MeansAreTheirDefinitions)
{
    // All pixels differ by 0.5 in red, of a reference 2, 1, 4.
    const ImageDifference d = difference(radiance({2.5f, 1, 4}), radiance({2, 1, 4}));
    EXPECT_DOUBLE_EQ(d.color->mse, 0.25 / 3);
    EXPECT_DOUBLE_EQ(d.color->peak, 4);
    EXPECT_NEAR(*d.color->psnr_db, 10 * std::log10(16 / (0.25 / 3)), 1e-9);
    EXPECT_NEAR(d.color->relmse, 0.25 / 4.01 / 3, 1e-9);
    EXPECT_TRUE(d.is_linear);
    EXPECT_GE(d.color->flip.exposures, 2);
}

TEST(ImageDifference, OfDisplayValuesHasPeakOne)
{
    const Image a = uniform_image(4, 3, {"R", "G", "B"}, {0.5f, 0.5f, 0.5f}, false),
                b = uniform_image(4, 3, {"R", "G", "B"}, {0.25f, 0.5f, 0.5f}, false);
    const ImageDifference d = difference(a, b);
    EXPECT_EQ(d.color->peak, 1);
    EXPECT_NEAR(*d.color->psnr_db, 10 * std::log10(1 / (0.0625 / 3)), 1e-4);
    EXPECT_EQ(d.color->flip.exposures, 0);
    // Linear values of the codes 0.5 and 0.25 are 0.214041 and 0.0508761.
    EXPECT_NEAR(d.color->relmse, std::pow(0.214041 - 0.0508761, 2) / (0.0508761 * 0.0508761 + 0.01) / 3, 1e-5);
}

TEST(ImageDifference, ValuesThatAreNotFinite)
{
    Image a = radiance({1, 1, 1}), b = radiance({1, 1, 1});
    a.layers[0].pixels[0] = nan, b.layers[0].pixels[0] = nan;
    a.layers[0].pixels[3] = inf, b.layers[0].pixels[3] = inf;
    ImageDifference d = difference(a, b);
    EXPECT_TRUE(d.is_same());
    EXPECT_EQ(d.invalid_pixels, 2u);
    EXPECT_EQ(d.color->flip.max, 0);

    b.layers[0].pixels[3] = 1, b.layers[0].pixels[6] = nan;
    d = difference(a, b, {"", 1e9});
    EXPECT_EQ(d.different_pixels, 2u);
    EXPECT_TRUE(std::isinf(d.largest.difference));
    EXPECT_EQ(d.color->mse, 0) << "means leave the pixels out";
    EXPECT_EQ(d.color->flip.map[1], 1);
    EXPECT_EQ(d.color->flip.map[2], 1);
}

TEST(ImageDifference, GrayEqualsItsColors)
{
    const Image gray = uniform_image(4, 3, {"Y"}, {0.5f}, false),
                color = uniform_image(4, 3, {"R", "G", "B"}, {0.5f, 0.5f, 0.5f}, false);
    const ImageDifference d = difference(gray, color);
    EXPECT_TRUE(d.is_same());
    EXPECT_TRUE(d.notes.empty());
}

TEST(ImageDifference, MissingAlphaIsOpaque)
{
    const Image opaque = uniform_image(4, 3, {"R", "G", "B"}, {0.5f, 0.5f, 0.5f}, false);
    EXPECT_TRUE(difference(uniform_image(4, 3, {"R", "G", "B", "A"}, {0.5f, 0.5f, 0.5f, 1}, false), opaque).is_same());
    const ImageDifference d =
        difference(uniform_image(4, 3, {"R", "G", "B", "A"}, {0.5f, 0.5f, 0.5f, 0.25f}, false), opaque);
    EXPECT_EQ(d.different_pixels, 12u);
    EXPECT_EQ(d.largest.channel, "A");
    EXPECT_EQ(d.notes, std::vector<std::string>{"b.exr has no alpha: it counts as opaque"});
    EXPECT_GT(d.color->flip.mean, 0.1) << "colors are those on black";
}

TEST(ImageDifference, TransparentPixelsLookAlike)
{
    const Image a = uniform_image(4, 3, {"R", "G", "B", "A"}, {1, 0, 0, 0}, false),
                b = uniform_image(4, 3, {"R", "G", "B", "A"}, {0, 1, 0, 0}, false);
    const ImageDifference d = difference(a, b);
    EXPECT_FALSE(d.is_same());
    EXPECT_EQ(d.color->flip.max, 0);
}

TEST(ImageDifference, ConvertsColorSpacesThatDiffer)
{
    // White of linear Rec.709 is white in ACEScg too.
    Image acescg = radiance({0.5f, 0.5f, 0.5f});
    acescg.chromaticities = Chromaticities{{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}};
    ImageDifference d = difference(acescg, radiance({0.5f, 0.5f, 0.5f}), {"", 1e-5});
    EXPECT_TRUE(d.is_same()) << d.largest.difference;
    ASSERT_EQ(d.notes.size(), 1u);
    EXPECT_NE(d.notes[0].find("Rec.709"), std::string::npos);
    // Images in one space are compared as they are stored, and perceived as what they are.
    Image red = acescg;
    for (std::size_t i = 0; i < 12; ++i) red.layers[0].pixels[3 * i] = 0.75f;
    d = difference(red, acescg);
    EXPECT_EQ(d.largest.difference, 0.25);
    EXPECT_TRUE(d.notes.empty());
    EXPECT_GT(d.color->relmse, std::pow(0.25, 2) / 0.26 / 3 * 1.5) << "red of ACEScg exceeds that of Rec.709";
}

TEST(ImageDifference, ComparesLayersThatAreNoColors)
{
    Image a = radiance({1, 1, 1}), b = a;
    a.layers.push_back({"depth", {"Z"}, std::vector<float>(12, inf)});
    b.layers.push_back({"depth", {"Z"}, std::vector<float>(12, inf)});
    b.layers[1].pixels[7] = 3;
    EXPECT_TRUE(difference(a, b).is_same());
    const ImageDifference d = difference(a, b, {"depth"});
    EXPECT_EQ(d.different_pixels, 1u);
    EXPECT_EQ(d.largest.x, 3);
    EXPECT_FALSE(d.color.has_value());
}

TEST(ImageDifference, SaysWhyImagesCannotBeCompared)
{
    const Image a = radiance({1, 1, 1});
    EXPECT_EQ(message(a, uniform_image(5, 3, {"R", "G", "B"}, {1, 1, 1}, true)),
              "a.exr: the image is 4x3, but b.exr is 5x3: only images of the same size can be compared");
    EXPECT_NE(message(a, uniform_image(4, 3, {"R", "G", "B"}, {1, 1, 1}, false))
                  .find("a.exr: the image is linear radiance, but b.exr is tone mapped"),
              std::string::npos);
    EXPECT_EQ(message(a, a, {"depth"}), "a.exr: it has no layer 'depth', but no layers");
    Image with_depth = a, other = a;
    with_depth.layers.push_back({"depth", {"Z"}, std::vector<float>(12)});
    other.layers.push_back({"depth", {"V"}, std::vector<float>(12)});
    EXPECT_EQ(message(with_depth, a, {"depth"}), "b.exr: it has no layer 'depth', but no layers");
    EXPECT_EQ(message(with_depth, a, {"depths"}), "a.exr: it has no layer 'depths', but depth");
    EXPECT_EQ(message(with_depth, other, {"depth"}), "a.exr: depth: it has the channels Z, but that of b.exr has V");
}

}  // namespace
}  // namespace fathom
