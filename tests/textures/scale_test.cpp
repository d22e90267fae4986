// SPDX-License-Identifier: Apache-2.0
#include "textures/scale.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

TEST(ScaleTexture, IsTheProductOfTwo)
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

}  // namespace
}  // namespace fathom::test
