// SPDX-License-Identifier: Apache-2.0
#include "textures/fractal.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

/// Values of pbrt-v4's own functions in double precision: fBm with five octaves of gain 0.6, and its windy texture.
struct Known {
    double p[3];
    double noise, fbm, wrinkled, windy;
};
constexpr Known known[] = {
    {{3.14, 42, 7}, 0.136919959, 0.466080142, 0.481632142, 0.003013911},
    {{0.3, 0.6, -0.2}, -0.133777739, 0.053134331, 0.336241809, 0.000052311},
    {{-5.7, 12.1, 100.45}, -0.488997847, -0.328955737, 0.664591958, -0.223600989},
    {{-300.25, 0.9, 17.6}, -0.129483519, -0.448081503, 0.463633503, -0.104374650},
    {{255.5, -0.5, 511.3}, -0.585844000, -0.739957314, 0.898412186, -0.123185772},
    {{7.45, -8.85, 3.35}, 0.247819734, 0.454167518, 0.619914747, 0.133958243},
};

TEST(FractalTextures, AreThoseOfPbrt)
{
    TextureFixture f;
    for (const Known& k : known) {
        const Vec3d p{k.p[0], k.p[1], k.p[2]};
        const auto value = [&](TextureKind kind) {
            TextureRecord t = TextureFixture::of(kind);
            t.gain = 0.6f, t.octaves = 5;
            return f.at_place(f.add(t), p)[1];
        };
        // Positions are floats, whose rounding errors are magnified by fine octaves.
        const double rounding = 4e-6 * (1 + length(p));
        EXPECT_NEAR(first(improved_noise(Vec3(to_float(p)))), k.noise, rounding);
        EXPECT_NEAR(value(TextureKind::fbm), k.fbm, rounding);
        EXPECT_NEAR(value(TextureKind::wrinkled), k.wrinkled, rounding);
        EXPECT_NEAR(value(TextureKind::windy), k.windy, rounding);
    }
}

TEST(FractalTextures, GoFromColourToColourAndStandInTheirSpace)
{
    TextureFixture f;
    // The space is x = 2 z' + 1, y = -x', z = 0.5 y' - 3.
    f.tables.texture_spaces = {{}, {{{{0, 0, 2, 1}, {-1, 0, 0, 0}, {0, 0.5f, 0, -3}}}}};
    TextureRecord t = TextureFixture::of(TextureKind::fbm);
    t.gain = 0.6f, t.octaves = 5, t.space = 1, t.scale = 0.5f;
    t.color_a = {1, 2, 3, 1}, t.color_b = {3, 2, 1, 1};
    const Known& k = known[5];
    const Rgba c = f.at_place(f.add(t), {-2 * k.p[1], 2 * (2 * k.p[2] + 3), (2 * k.p[0] - 1) / 2});
    EXPECT_NEAR(c[0], 1 + 2 * k.fbm, 2e-4);
    EXPECT_NEAR(c[1], 2, 1e-6);
    EXPECT_NEAR(c[2], 3 - 2 * k.fbm, 2e-4);
}

/// Colors are those of pbrt's marble, by Bezier's formula from its nine control colors.
TEST(FractalTextures, MarbleHasItsVeins)
{
    const double colors[9][3] = {{.58, .58, .6}, {.58, .58, .6}, {.58, .58, .6}, {.5, .5, .5},  {.6, .59, .58},
                                 {.58, .58, .6}, {.58, .58, .6}, {.2, .2, .33},  {.58, .58, .6}};
    TextureFixture f;
    TextureRecord t = TextureFixture::of(TextureKind::veined_marble);
    t.gain = 0.6f, t.octaves = 5, t.turbulence_weight = 3, t.scale = 2;
    const std::uint32_t marble = f.add(t);
    for (const Known& k : known) {
        if (length(Vec3d{k.p[0], k.p[1], k.p[2]}) > 50) continue;
        const double x = 3 + 3 * std::sin(k.p[1] + 3 * k.fbm), s = x - std::floor(x), r = 1 - s;
        const Rgba c = f.at_place(marble, {k.p[0] / 2, k.p[1] / 2, k.p[2] / 2});
        for (std::size_t i = 0; i < 3; ++i) {
            const auto at = [&](int j) { return colors[int(std::floor(x)) + j][i]; };
            const double gray = r * r * r * at(0) + 3 * r * r * s * at(1) + 3 * r * s * s * at(2) + s * s * s * at(3);
            EXPECT_NEAR(c[i], 1.5 * gray, 1e-4);
        }
    }
}

}  // namespace
}  // namespace fathom::test
