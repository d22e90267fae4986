// SPDX-License-Identifier: Apache-2.0
#include "textures/facing.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

/// The fixture's normal is +z.
TEST(FacingTexture, IsTheCosineOnEitherSide)
{
    TextureFixture f;
    TextureRecord t = TextureFixture::of(TextureKind::facing);
    t.color_a = {2, 0, 0, 1}, t.color_b = {0, 4, 0, 1};
    for (const float sign : {1.f, -1.f}) {
        t.direction = {0.8f, 0, 0.6f * sign};
        const Rgba c = f.at(f.add(t));
        EXPECT_NEAR(c[0], 0.8, 1e-6);
        EXPECT_NEAR(c[1], 2.4, 1e-6);
    }
}

}  // namespace
}  // namespace fathom::test
