// SPDX-License-Identifier: Apache-2.0
#include "texture_checks.h"
#include "textures/image.h"

namespace fathom::test {
namespace {

/// An image of 4 x 4 texels that encode their position: red the column, green the row.
TextureRecord places(TextureFixture& f)
{
    TextureRecord t = TextureFixture::of(TextureKind::image);
    t.width = t.height = 4;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
            for (const float v : {float(x), float(y), 1.f, 1.f}) f.tables.texels.push_back(v);
    return t;
}

TEST(ImageEdges, BlackIsNothingOutside)
{
    TextureFixture f;
    TextureRecord t = places(f);
    t.wrap_u = std::uint32_t(Wrap::black), t.wrap_v = std::uint32_t(Wrap::repeat);
    t.nearest = 1;
    const std::uint32_t sharp = f.add(t);
    EXPECT_EQ(f.at(sharp, 0.9f, 1.4f), (Rgba{3, 1, 1, 1}));
    EXPECT_EQ(f.at(sharp, 1.01f, 0.4f), (Rgba{0, 0, 0, 0}));
    EXPECT_EQ(f.at(sharp, -0.01f, 0.4f), (Rgba{0, 0, 0, 0}));
    t.nearest = 0;
    // Half a texel beyond the center of the last texel the value is half.
    EXPECT_EQ(f.at(f.add(t), 1, 0.375f), (Rgba{1.5f, 0.5f, 0.5f, 0.5f}));
    std::swap(t.wrap_u, t.wrap_v);
    EXPECT_EQ(f.at(f.add(t), 0.375f, 0), (Rgba{0.5f, 0, 0.5f, 0.5f}));
    EXPECT_EQ(f.at(f.add(t), 1.375f, 1.3f), (Rgba{0, 0, 0, 0}));
}

/// Across an edge of an octahedral map lies the same edge, mirrored about its midpoint.
TEST(ImageEdges, OctahedralFolds)
{
    TextureFixture f;
    TextureRecord t = places(f);
    t.wrap_u = t.wrap_v = std::uint32_t(Wrap::octahedral);
    t.nearest = 1;
    const std::uint32_t sharp = f.add(t);
    EXPECT_EQ(f.at(sharp, 0.3f, 0.6f), (Rgba{1, 2, 1, 1}));
    EXPECT_EQ(f.at(sharp, -0.1f, 0.1f), (Rgba{0, 3, 1, 1}));
    EXPECT_EQ(f.at(sharp, 1.1f, 0.6f), (Rgba{3, 1, 1, 1}));
    EXPECT_EQ(f.at(sharp, 0.1f, -0.3f), (Rgba{3, 1, 1, 1}));
    EXPECT_EQ(f.at(sharp, 0.6f, 1.3f), (Rgba{1, 2, 1, 1}));
    t.nearest = 0;
    // Therefore lookup is continuous across the edge.
    const std::uint32_t smooth = f.add(t);
    const Rgba inside = f.at(smooth, 1e-6f, 0.2f), outside = f.at(smooth, -1e-6f, 0.8f);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(inside[c], outside[c], 1e-4);
}

}  // namespace
}  // namespace fathom::test
