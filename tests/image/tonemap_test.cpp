#include "image/tonemap.h"

#include <gtest/gtest.h>

#include "pictures.h"

namespace fathom {
namespace {

TEST(Tonemap, SrgbCodesByHand)
{
    const DisplayMap map({0, Tonemap::srgb});
    // 255 (1.055 x^(1/2.4) - 0.055), and 255 12.92 x below 0.0031308
    EXPECT_EQ(map.code8(0), 0);
    EXPECT_EQ(map.code8(0.001f), 3);       // 3.29
    EXPECT_EQ(map.code8(0.0031308f), 10);  // 10.31
    EXPECT_EQ(map.code8(0.18f), 118);      // 117.7
    EXPECT_EQ(map.code8(0.5f), 188);       // 187.5
    EXPECT_EQ(map.code8(1), 255);
    EXPECT_EQ(map.code8(7), 255);
    EXPECT_EQ(map.code8(-1), 0);
    EXPECT_EQ(map.code8(NAN), 0);
    EXPECT_EQ(map.code8(INFINITY), 255);
    EXPECT_EQ(map.code16(0.18f), 30235);  // 65535 * 0.461356
    EXPECT_EQ(map.code16(NAN), 0);
    EXPECT_EQ(map.code16(INFINITY), 65535);
}

TEST(Tonemap, ExposureIsInStops)
{
    EXPECT_EQ(DisplayMap({1, Tonemap::srgb}).code8(0.25f), DisplayMap({0, Tonemap::srgb}).code8(0.5f));
    EXPECT_EQ(DisplayMap({-2, Tonemap::srgb}).code16(1), DisplayMap({0, Tonemap::srgb}).code16(0.25f));
}

TEST(Tonemap, FilmicByHand)
{
    EXPECT_FLOAT_EQ(filmic_curve(0), 0);
    EXPECT_FLOAT_EQ(filmic_curve(1), 2.54f / 3.16f);
    EXPECT_FLOAT_EQ(filmic_curve(0.18f), 0.086724f / 0.324932f);
    EXPECT_NEAR(filmic_curve(1e30f), 2.51 / 2.43, 1e-4);
    const DisplayMap map({0, Tonemap::filmic});
    EXPECT_EQ(map.code8(1), 232);  // sRGB of 0.803797: 0.908232 * 255 = 231.6
    // Exposed before, not after the curve.
    EXPECT_EQ(DisplayMap({2, Tonemap::filmic}).code8(0.25f), 232);
    EXPECT_EQ(map.code8(INFINITY), 255);
    EXPECT_EQ(map.code8(NAN), 0);
    float before = 0;
    for (int i = 0; i < 2000; ++i) {
        const float value = filmic_curve(float(i) * 0.01f);
        EXPECT_GE(value, before);
        before = value;
    }
}

TEST(Tonemap, TheTableIsTheFormula)
{
    const DisplayMap map({0, Tonemap::srgb});
    float x = 1e-5f;
    while (x < 1.1f) {
        const double code = test::srgb(x) * 255;
        ASSERT_NEAR(map.code8(x), code, 0.50001) << x;
        x *= 1.00003f;
    }
}

TEST(ToDisplay, IsStraightRgba)
{
    const Image::Layer layer{"", {"R", "G", "B", "A"}, {0.25f, 0.09f, 0, 0.5f}};
    EXPECT_EQ(to_display(layer, 1, 1, {}), (std::vector<unsigned char>{188, 118, 0, 128}));
    const Image::Layer grey{"depth", {"Z"}, {0.18f}};
    EXPECT_EQ(to_display(grey, 1, 1, {}), (std::vector<unsigned char>{118, 118, 118, 255}));
    const Image::Layer normal{"normal", {"X", "Y", "Z"}, {1, -1, 0.5f}};
    EXPECT_EQ(to_display(normal, 1, 1, {}), (std::vector<unsigned char>{255, 0, 188, 255}));
}

}  // namespace
}  // namespace fathom
