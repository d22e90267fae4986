// SPDX-License-Identifier: Apache-2.0
#include "image/color/primaries.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fathom/error.h"
#include "image/pictures.h"

namespace fathom {
namespace {

std::array<double, 3> times(const ColorMatrix& m, const std::array<double, 3>& v)
{
    std::array<double, 3> product{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) product[i] += m[i][k] * v[k];
    return product;
}

void expect_near(const ColorMatrix& m, const ColorMatrix& expected, double tolerance)
{
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(m[i][k], expected[i][k], tolerance) << i << k;
}

/// Matrix of the ACES configurations for OpenColorIO ("Utility - Linear - sRGB"), and its inverse.
constexpr ColorMatrix published_acescg{{{0.6130974024, 0.3395231462, 0.0473794514},
                                        {0.0701937225, 0.9163538791, 0.0134523985},
                                        {0.0206155929, 0.1095697729, 0.8698146342}}};
constexpr ColorMatrix published_rec709{{{1.7050509926, -0.6217921207, -0.0832588719},
                                        {-0.1302564175, 1.1408047366, -0.0105483191},
                                        {-0.0240033568, -0.1289689761, 1.1529723329}}};

TEST(Primaries, MatricesAreThePublishedOnes)
{
    expect_near(conversion(rec709_chromaticities, acescg_chromaticities), published_acescg, 1e-6);
    expect_near(conversion(acescg_chromaticities, rec709_chromaticities), published_rec709, 1e-6);
}

TEST(Primaries, WhiteStaysWhite)
{
    // The color spaces are Display P3 (D65), ROMM (D50) and CIE XYZ (E).
    const Chromaticities others[] = {{{0.68f, 0.32f}, {0.265f, 0.69f}, {0.15f, 0.06f}, {0.3127f, 0.329f}},
                                     {{0.7347f, 0.2653f}, {0.1596f, 0.8404f}, {0.0366f, 0.0001f}, {0.3457f, 0.3585f}},
                                     {{1, 0}, {0, 1}, {0, 0}, {1 / 3.f, 1 / 3.f}},
                                     acescg_chromaticities};
    for (const Chromaticities& other : others) {
        const ColorMatrix to = conversion(rec709_chromaticities, other),
                          back = conversion(other, rec709_chromaticities);
        for (const double v : times(to, {1, 1, 1})) EXPECT_NEAR(v, 1, 1e-12);
        const auto again = times(back, times(to, {0.2, 0.7, 0.4}));
        EXPECT_NEAR(again[0], 0.2, 1e-12);
        EXPECT_NEAR(again[1], 0.7, 1e-12);
        EXPECT_NEAR(again[2], 0.4, 1e-12);
    }
}

/// There is no chromatic adaptation for equal white points: red of Rec.709 has the XYZ values of IEC 61966-2-1.
TEST(Primaries, RedOfRec709InXyz)
{
    const Chromaticities xyz{{1, 0}, {0, 1}, {0, 0}, {0.3127f, 0.329f}};
    const ColorMatrix m = conversion(rec709_chromaticities, xyz);
    // XYZ are relative to white, which becomes (1, 1, 1).
    const double white[] = {0.3127 / 0.329, 1, 0.3583 / 0.329};
    const double red[] = {0.4124, 0.2126, 0.0193};
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(m[i][0] * white[i], red[i], 5e-5);
}

/// CIE 15 gives the white points of D50, D55, D65, D75, and of illuminant A at 2856 K.
TEST(Primaries, WhitesOfTemperatures)
{
    struct Known {
        double kelvin, x, y;
    };
    for (const auto& [kelvin, x, y] :
         {Known{5003, 0.34567, 0.35850}, Known{5503, 0.33242, 0.34743}, Known{6504, 0.31272, 0.32903},
          Known{7504, 0.29902, 0.31485}, Known{2856, 0.44758, 0.40745}, Known{1000, 0.65275, 0.34446}}) {
        const Vec2f white = white_chromaticity(kelvin);
        EXPECT_NEAR(white.x, x, 4e-4) << kelvin;
        EXPECT_NEAR(white.y, y, 4e-4) << kelvin;
    }
}

/// White balance for illuminant A makes its chromaticity gray at equal luminance; daylight changes only by the rounding
/// of D65.
TEST(Primaries, WhiteBalance)
{
    const double x = 0.44758, y = 0.40745, xyz[] = {x / y, 1, (1 - x - y) / y};
    const ColorMatrix rec709{
        {{3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}}};
    for (const double v : times(white_balance(2856), times(rec709, {xyz[0], xyz[1], xyz[2]}))) EXPECT_NEAR(v, 1, 6e-3);
    const auto daylight = times(white_balance(6504), {0.2, 0.7, 0.4});
    EXPECT_NEAR(daylight[0], 0.2, 5e-4);
    EXPECT_NEAR(daylight[1], 0.7, 5e-4);
    EXPECT_NEAR(daylight[2], 0.4, 5e-4);
}

TEST(Primaries, RejectsDegeneratePrimaries)
{
    EXPECT_THROW(conversion({{0, 0}, {0.5f, 0.5f}, {1, 1}, {0.3f, 0.3f}}, rec709_chromaticities), Error);
    EXPECT_THROW(conversion({{0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3f, 0}}, rec709_chromaticities), Error);
    EXPECT_THROW(conversion({{0.64f, NAN}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3f, 0.3f}}, rec709_chromaticities), Error);
}

TEST(Exr, RecordsOtherPrimaries)
{
    const test::TemporaryFolder folder;
    Image image = test::make_test_image(7, 5, {"R", "G", "B", "A"}, 3);
    image.layers.push_back(test::make_test_layer("albedo", {"R", "G", "B"}, 7, 5));
    image.layers.push_back(test::make_test_layer("variance", {"R", "G", "B"}, 7, 5));
    image.layers.push_back(test::make_test_layer("normal", {"X", "Y", "Z"}, 7, 5));
    image.uint_channels.push_back({"sums.000", std::vector<std::uint32_t>(35, 7)});
    image.layers[0].pixels[0] = INFINITY;
    WriteOptions options;
    write_image(folder.path() / "rec709.exr", image, options);
    EXPECT_FALSE(read_image(folder.path() / "rec709.exr").chromaticities);
    options.exr_primaries = Primaries::acescg;
    write_image(folder.path() / "acescg.exr", image, options);
    const Image read = read_image(folder.path() / "acescg.exr");
    ASSERT_TRUE(read.chromaticities);
    EXPECT_TRUE(is_same(*read.chromaticities, acescg_chromaticities));
    for (const char* const name : {"", "albedo"}) {
        const Image::Layer &from = *image.find(name), &to = *read.find(name);
        const std::size_t stride = from.channels.size();
        ASSERT_EQ(to.channels, from.channels);
        for (std::size_t at = *name ? 0 : stride; at < from.pixels.size(); at += stride) {
            const auto expected = times(
                published_acescg, {double(from.pixels[at]), double(from.pixels[at + 1]), double(from.pixels[at + 2])});
            for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(to.pixels[at + c], expected[c], 1e-5);
            if (stride == 4) {
                ASSERT_EQ(to.pixels[at + 3], from.pixels[at + 3]);
            }
        }
    }
    EXPECT_EQ(read.layers[0].pixels[0], INFINITY);
    EXPECT_EQ(read.find("variance")->pixels, image.find("variance")->pixels);
    EXPECT_EQ(read.find("normal")->pixels, image.find("normal")->pixels);
    EXPECT_EQ(read.uint_channels[0].values, image.uint_channels[0].values);
}

}  // namespace
}  // namespace fathom
