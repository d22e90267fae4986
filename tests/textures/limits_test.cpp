// SPDX-License-Identifier: Apache-2.0
#include "textures/limits.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

TEST(LimitTextures, AreByChannelAndLeaveAlphaAlone)
{
    TextureFixture f;
    TextureRecord t = TextureFixture::of(TextureKind::invert);
    t.color_a = {2, 1, 1, 1};
    t.texture_a = f.add_color(0.75f, 0.25f, -0.5f, 0.5f);
    // add_color is a product with white.
    EXPECT_EQ(f.at(f.add(t)), (Rgba{0, 0.75f, 1.5f, 0.5f}));
    t.kind = std::uint32_t(TextureKind::clamp);
    EXPECT_EQ(f.at(f.add(t)), (Rgba{1, 0.25f, 0, 0.5f}));
}

}  // namespace
}  // namespace fathom::test
