// SPDX-License-Identifier: Apache-2.0
#include "image/color/tonemap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "image/color/tone_curves.h"
#include "image/pictures.h"

namespace fathom {
namespace {

/// 8-bit code of a gray value; the three channels must agree.
int code8(const DisplayMap& map, float x)
{
    const auto codes = map.codes8({x, x, x});
    EXPECT_EQ(codes[0], codes[1]);
    EXPECT_EQ(codes[0], codes[2]);
    return codes[0];
}
int code16(const DisplayMap& map, float x)
{
    const auto codes = map.codes16({x, x, x});
    EXPECT_EQ(codes[0], codes[1]);
    EXPECT_EQ(codes[0], codes[2]);
    return codes[0];
}

using Rgb = std::array<double, 3>;
using Matrix3 = std::array<Rgb, 3>;

Rgb product(const Matrix3& m, const Rgb& v)
{
    Rgb result{};
    for (int i = 0; i < 3; ++i) result[i] = std::inner_product(v.begin(), v.end(), m[i].begin(), 0.0);
    return result;
}

Matrix3 inverse(const Matrix3& m)
{
    Matrix3 adjoint;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            adjoint[j][i] = m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3] -
                            m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3];
    const double determinant = m[0][0] * adjoint[0][0] + m[0][1] * adjoint[1][0] + m[0][2] * adjoint[2][0];
    for (Rgb& row : adjoint)
        for (double& x : row) x /= determinant;
    return adjoint;
}

TEST(Tonemap, SrgbCodesByHand)
{
    const DisplayMap map({0, Tonemap::srgb});
    // Codes are 255 (1.055 x^(1/2.4) - 0.055), and 255 * 12.92 x below 0.0031308.
    EXPECT_EQ(code8(map, 0), 0);
    EXPECT_EQ(code8(map, 0.001f), 3);       // 3.29 before rounding
    EXPECT_EQ(code8(map, 0.0031308f), 10);  // 10.31 before rounding
    EXPECT_EQ(code8(map, 0.18f), 118);      // 117.7 before rounding
    EXPECT_EQ(code8(map, 0.5f), 188);       // 187.5 before rounding
    EXPECT_EQ(code8(map, 1), 255);
    EXPECT_EQ(code8(map, 7), 255);
    EXPECT_EQ(code8(map, -1), 0);
    EXPECT_EQ(code8(map, NAN), 0);
    EXPECT_EQ(code8(map, INFINITY), 255);
    EXPECT_EQ(code16(map, 0.18f), 30235);  // 65535 * 0.461356 before rounding
    EXPECT_EQ(code16(map, NAN), 0);
    EXPECT_EQ(code16(map, INFINITY), 65535);
}

TEST(Tonemap, ExposureIsInStops)
{
    EXPECT_EQ(code8(DisplayMap({1, Tonemap::srgb}), 0.25f), code8(DisplayMap({0, Tonemap::srgb}), 0.5f));
    EXPECT_EQ(code16(DisplayMap({-2, Tonemap::srgb}), 1), code16(DisplayMap({0, Tonemap::srgb}), 0.25f));
}

TEST(Tonemap, FilmicByHand)
{
    EXPECT_FLOAT_EQ(filmic_curve(0), 0);
    EXPECT_FLOAT_EQ(filmic_curve(1), 2.54f / 3.16f);
    EXPECT_FLOAT_EQ(filmic_curve(0.18f), 0.086724f / 0.324932f);
    EXPECT_NEAR(filmic_curve(1e6f), 2.51 / 2.43, 1e-4);
    const DisplayMap map({0, Tonemap::filmic});
    EXPECT_EQ(code8(map, 1), 232);  // sRGB of 0.803797: 0.908232 * 255 = 231.6
    // Exposure is applied before the curve.
    EXPECT_EQ(code8(DisplayMap({2, Tonemap::filmic}), 0.25f), 232);
    EXPECT_EQ(code8(map, INFINITY), 255);
    EXPECT_EQ(code8(map, NAN), 0);
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
        ASSERT_NEAR(code8(map, x), code, 0.50001) << x;
        x *= 1.00003f;
    }
}

/// Hill's ACES fit in double precision with its matrices multiplied, as glTF viewers use it.
Rgb hill(const Rgb& radiance)
{
    const double in[3][3] = {{.59719, .35458, .04823}, {.07600, .90834, .01566}, {.02840, .13383, .83777}};
    const double out[3][3] = {{1.60475, -.53108, -.07367}, {-.10208, 1.10813, -.00605}, {-.00327, -.07276, 1.07602}};
    Rgb v{}, shown{};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) v[i] += in[i][j] * radiance[j] / 0.6;
        v[i] = (v[i] * (v[i] + .0245786) - .000090537) / (v[i] * (.983729 * v[i] + .4329510) + .238081);
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) shown[i] += out[i][j] * v[j];
        shown[i] = std::clamp(shown[i], 0.0, 1.0);
    }
    return shown;
}

/// AgX, computed from its sources: primaries of Rec.709 and Rec.2020, and the inverse of the outset matrix of Blender's
/// configuration.
Rgb sobotka(const Rgb& radiance)
{
    // The matrix from Rec.709 to Rec.2020 is that of ITU-R BT.2087; its inverse converts back.
    const Matrix3 to_2020 = {
        {{0.6274039, 0.3292830, 0.0433131}, {0.0690973, 0.9195404, 0.0113623}, {0.0163914, 0.0880133, 0.8955953}}};
    const Matrix3 inset = {{{0.856627153315983, 0.0951212405381588, 0.0482516061458583},
                            {0.137318972929847, 0.761241990602591, 0.101439036467562},
                            {0.11189821299995, 0.0767994186031903, 0.811302368396859}}};
    // The inverse outset is Blender's: E. Chow's AgXBaseRec2020, rounded.
    const Matrix3 before_outset = {{{0.899796955911611, 0.0871996192028351, 0.013003424885555},
                                    {0.11142098895748, 0.875575586156966, 0.0130034248855548},
                                    {0.11142098895748, 0.0871996192028349, 0.801379391839686}}};
    Rgb v = product(inset, product(to_2020, radiance));
    for (double& x : v) {
        // The curve is Blender's polynomial in Horner's form instead of powers.
        const double ev = std::log2(std::max(x, 1e-10)), least = std::log2(0.18) - 10, most = std::log2(0.18) + 6.5;
        const double t = std::clamp((ev - least) / (most - least), 0.0, 1.0);
        x = -0.00232 + t * (0.1191 + t * (0.4298 + t * (-6.868 + t * (31.96 + t * (-40.14 + t * 15.5)))));
    }
    v = product(inverse(before_outset), v);
    for (double& x : v) x = std::pow(std::max(x, 0.0), 2.2);
    v = product(inverse(to_2020), v);
    for (double& x : v) x = std::clamp(x, 0.0, 1.0);
    return v;
}

/// Khronos PBR Neutral by its specification: subtract F90, compress the largest channel, then desaturate.
Rgb neutral(const Rgb& radiance)
{
    const auto [least, most] = std::minmax_element(radiance.begin(), radiance.end());
    const double x = *least, f = x <= 0.08 ? x - x * x / 0.16 : 0.04, peak = *most - f;
    Rgb shown = radiance;
    for (double& c : shown) c -= f;
    if (peak <= 0.76) return shown;
    const double squeezed = 1 - 0.24 * 0.24 / (peak + 0.24 - 0.76);
    const double keep = 1 / (0.15 * (peak - squeezed) + 1);
    for (double& c : shown) c = keep * c * squeezed / peak + (1 - keep) * squeezed;
    return shown;
}

TEST(Tonemap, CurvesAreTheirFormulae)
{
    std::uint32_t state = 7;
    const auto random = [&] { return double((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24; };
    for (int i = 0; i < 3000; ++i) {
        // Values range from 2^-12 to 2^8, and some channels are black.
        Rgb c{};
        for (double& x : c) x = random() < 0.1 ? 0 : double(float(std::exp2(20 * random() - 12)));
        const Color radiance{float(c[0]), float(c[1]), float(c[2])};
        const auto expect = [&](Tonemap tonemap, const Rgb& expected, double tolerance) {
            const Color shown = tone_map(tonemap, radiance);
            const float channels[] = {shown.r, shown.g, shown.b};
            for (int k = 0; k < 3; ++k)
                ASSERT_NEAR(channels[k], expected[k], tolerance)
                    << tonemap_names[int(tonemap)] << " " << c[0] << " " << c[1] << " " << c[2];
        };
        expect(Tonemap::aces, hill(c), 3e-6);
        expect(Tonemap::khronos_neutral, neutral(c), 3e-6);
        // AgX's published matrices are rounded to four digits.
        expect(Tonemap::agx, sobotka(c), 3e-4);
    }
}

/// Curves are monotonic, map black to black, and very bright light to white.
TEST(Tonemap, CurvesRiseFromBlackToWhite)
{
    for (int t = 0; t < int(std::size(tonemap_names)); ++t) {
        const DisplayMap map({0, Tonemap(t)});
        EXPECT_EQ(code8(map, 0), 0) << tonemap_names[t];
        EXPECT_EQ(code8(map, -3), 0) << tonemap_names[t];
        EXPECT_EQ(code8(map, NAN), 0) << tonemap_names[t];
        EXPECT_GE(code8(map, INFINITY), 253) << tonemap_names[t];
        int before = 0;
        for (int i = 0; i < 2777; ++i) {
            const float x = 1e-5f * std::pow(1.01f, float(i));
            const auto codes = map.codes16({x, x, x});
            ASSERT_GE(codes[1], before) << tonemap_names[t] << " " << x;
            before = codes[1];
            // Gray stays gray, up to the rounding of the matrices.
            const auto [least, most] = std::minmax_element(codes.begin(), codes.end());
            ASSERT_LE(*most - *least, 60) << tonemap_names[t] << " " << x;
        }
    }
}

/// White balance of 2856 K makes light of illuminant A (x 0.4476, y 0.4075: 1.85, 0.83 and 0.23 at luminance 1) gray
/// with its luminance times the exposure.
TEST(Tonemap, WhiteBalanceMakesLampsWhite)
{
    const auto gray =
        DisplayMap({-1, Tonemap::srgb, {}, 2856}).codes8({0.364f * 1.8451f, 0.364f * 0.8261f, 0.364f * 0.2333f});
    // Code 118 is a linear value of 0.182.
    for (const int code : gray) EXPECT_NEAR(code, 118, 1.5);
    EXPECT_EQ(DisplayMap({0, Tonemap::srgb, {}, 2856}).codes8({NAN, NAN, NAN})[2], 0);
    // Light bluer than daylight is balanced to a warmer color.
    const auto warm = DisplayMap({0, Tonemap::srgb, {}, 10000}).codes8({0.5f, 0.5f, 0.5f});
    EXPECT_GT(warm[0], 188);
    EXPECT_LT(warm[2], 188);
}

/// Base colors up to 0.8 plus 4 % specular reflection under white light are reproduced exactly.
TEST(Tonemap, NeutralKeepsSurfaceColors)
{
    for (const Color& base : {Color{0.6f, 0.1f, 0.05f}, {0.75f, 0.75f, 0.7f}, {0.05f, 0.2f, 0.4f}}) {
        const Color shown = tone_map(Tonemap::khronos_neutral, {base.r + 0.04f, base.g + 0.04f, base.b + 0.04f});
        EXPECT_NEAR(shown.r, base.r, 1e-6);
        EXPECT_NEAR(shown.g, base.g, 1e-6);
        EXPECT_NEAR(shown.b, base.b, 1e-6);
    }
    // NaN in one channel is treated as 0, so other channels stay valid.
    const auto codes = DisplayMap({0, Tonemap::agx}).codes8({NAN, 1, 0.2f});
    EXPECT_EQ(codes, DisplayMap({0, Tonemap::agx}).codes8({0, 1, 0.2f}));
}

TEST(ToDisplay, IsStraightRgba)
{
    const Image::Layer layer{"", {"R", "G", "B", "A"}, {0.25f, 0.09f, 0, 0.5f}};
    EXPECT_EQ(to_display(layer, 1, 1, {}), (std::vector<unsigned char>{188, 118, 0, 128}));
    const Image::Layer gray{"depth", {"Z"}, {0.18f}};
    EXPECT_EQ(to_display(gray, 1, 1, {}), (std::vector<unsigned char>{118, 118, 118, 255}));
    const Image::Layer normal{"normal", {"X", "Y", "Z"}, {1, -1, 0.5f}};
    EXPECT_EQ(to_display(normal, 1, 1, {}), (std::vector<unsigned char>{255, 0, 188, 255}));
}

}  // namespace
}  // namespace fathom
