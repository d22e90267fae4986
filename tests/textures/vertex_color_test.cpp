// SPDX-License-Identifier: Apache-2.0
#include "textures/vertex_color.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

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
