// SPDX-License-Identifier: Apache-2.0
#include "textures/mix.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

TEST(MixTexture, GoesFromOneColourToTheOther)
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

/// Luminance weights of Rec. 709, with uniform and varying operands.
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

}  // namespace
}  // namespace fathom::test
