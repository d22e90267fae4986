// SPDX-License-Identifier: Apache-2.0
#include "textures/surface.h"

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

TEST(VertexColorTexture, ShowsTheMeshsColours)
{
    TextureFixture f;
    EXPECT_EQ(f.at(f.add(TextureFixture::of(TextureKind::vertex_color))), (Rgba{0.125f, 0.25f, 0.375f, 0.5f}));
    // Vertex colors are also available to a node that another one refers to.
    TextureRecord product = TextureFixture::of(TextureKind::scale);
    product.color_a = {2, 2, 2, 1};
    product.texture_a = 0;
    EXPECT_EQ(f.at(f.add(product)), (Rgba{0.25f, 0.5f, 0.75f, 0.5f}));
}

}  // namespace
}  // namespace fathom::test
