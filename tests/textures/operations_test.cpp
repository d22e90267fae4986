// SPDX-License-Identifier: Apache-2.0
#include "textures/operations.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

TEST(MixTexture, InterpolatesLinearly)
{
    TextureFixture f;
    TextureRecord mix = TextureFixture::of(TextureKind::mix);
    mix.color_a = {0.2f, 0.4f, 0, 1};
    mix.color_b = {1, 0, 0.5f, 1};
    for (const float factor : {0.0f, 0.25f, 1.0f}) {
        mix.factor = factor;
        const Rgba c = f.at(f.add(mix));
        EXPECT_FLOAT_EQ(c[0], 0.2f + factor * 0.8f);
        EXPECT_FLOAT_EQ(c[1], 0.4f - factor * 0.4f);
        EXPECT_FLOAT_EQ(c[2], factor * 0.5f);
        EXPECT_FLOAT_EQ(c[3], 1);
    }
}

TEST(MixTexture, MixesTexturesByAChannelOfAThird)
{
    TextureFixture f;
    TextureRecord mix = TextureFixture::of(TextureKind::mix);
    mix.color_a = mix.color_b = {1, 1, 1, 1};
    mix.texture_a = f.add_color(1, 0, 0, 0.5f);
    mix.texture_b = f.add_color(0, 0, 1);
    mix.factor_texture = f.add_color(0.1f, 0.3f, 0.6f, 0.9f);
    mix.factor = 0.5f;
    const float channels[] = {0.1f, 0.3f, 0.6f, 0.9f};
    for (std::uint32_t channel = 0; channel < 4; ++channel) {
        mix.factor_channel = channel;
        const float share = 0.5f * channels[channel];
        const Rgba c = f.at(f.add(mix));
        EXPECT_FLOAT_EQ(c[0], 1 - share);
        EXPECT_FLOAT_EQ(c[2], share);
        EXPECT_FLOAT_EQ(c[3], 0.5f + 0.5f * share);
    }
}

/// Luminance has the weights of Rec. 709, with uniform and varying operands.
TEST(MixTexture, FactorsByLuminance)
{
    TextureFixture f;
    TextureRecord mix = TextureFixture::of(TextureKind::mix);
    mix.color_a = {0, 0, 0, 1}, mix.color_b = {1, 1, 1, 1};
    mix.factor_texture = f.add_color(0.5f, 0.25f, 0.75f, 0.1f);
    mix.factor = 1;
    mix.factor_channel = luminance_channel;
    EXPECT_NEAR(f.at(f.add(mix))[0], 0.33925, 1e-6);
    const Texel texel{{Float(0.5f), Float(0.25f), Float(0.75f), Float(0.1f)}};
    EXPECT_NEAR(first(texel.channel(UInt(std::uint32_t(luminance_channel)))), 0.33925, 1e-6);
    EXPECT_EQ(first(texel.channel(UInt(3u))), 0.1f);
}

TEST(ScaleTexture, MultipliesTwoColors)
{
    TextureFixture f;
    TextureRecord product = TextureFixture::of(TextureKind::scale);
    product.color_a = {0.5f, 1, 2, 1};
    product.texture_a = f.add_color(1, 0.5f, 0.25f, 0.75f);
    product.color_b = {0.5f, 0.5f, 3, 1};
    product.texture_b = f.add_color(0.1f, 1, 1, 0.5f);
    const Rgba c = f.at(f.add(product));
    EXPECT_FLOAT_EQ(c[0], 0.5f * 1 * 0.5f * 0.1f);
    EXPECT_FLOAT_EQ(c[1], 1 * 0.5f * 0.5f * 1);
    EXPECT_FLOAT_EQ(c[2], 2 * 0.25f * 3 * 1);
    EXPECT_FLOAT_EQ(c[3], 0.75f * 0.5f);
}

TEST(InvertAndClampTextures, AreByChannelAndKeepAlpha)
{
    TextureFixture f;
    TextureRecord t = TextureFixture::of(TextureKind::invert);
    t.color_a = {2, 1, 1, 1};
    t.texture_a = f.add_color(0.75f, 0.25f, -0.5f, 0.5f);
    // The texture is a product with white.
    EXPECT_EQ(f.at(f.add(t)), (Rgba{0, 0.75f, 1.5f, 0.5f}));
    t.kind = std::uint32_t(TextureKind::clamp);
    EXPECT_EQ(f.at(f.add(t)), (Rgba{1, 0.25f, 0, 0.5f}));
}

TEST(UvTransformTexture, TransformsTheCoordinatesOfItsInput)
{
    TextureFixture f;
    TextureRecord checker = TextureFixture::of(TextureKind::checker_uv);
    TextureRecord moved = TextureFixture::of(TextureKind::uv_transform);
    moved.color_a = {0.5f, 1, 1, 1};
    moved.texture_a = f.add(checker);
    // The map is u' = 2 v + 0.25, v' = u - 3.
    moved.uv_map = {0, 2, 0.25f, 1, 0, -3};
    const std::uint32_t texture = f.add(moved);
    for (const auto& [u, v] : {std::pair{0.1f, 0.2f}, {0.6f, 0.45f}, {1.2f, 0.1f}, {3.5f, 1.9f}}) {
        const int cell = int(std::floor(2 * v + 0.25f)) + int(std::floor(u - 3));
        EXPECT_FLOAT_EQ(f.at(texture, u, v)[0], cell % 2 == 0 ? 0 : 0.5f) << u << ' ' << v;
    }
}

}  // namespace
}  // namespace fathom::test
