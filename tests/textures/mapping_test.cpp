// SPDX-License-Identifier: Apache-2.0
#include "textures/mapping.h"

#include <numbers>

#include "texture_checks.h"

namespace fathom::test {
namespace {

TEST(Mapping, CoordinatesComeFromThePlace)
{
    TextureFixture f;
    TextureRecord t = TextureFixture::of(TextureKind::coordinates);
    const auto at = [&](TextureMapping mapping, Vec3d p) {
        t.mapping = std::uint32_t(mapping);
        return f.at_place(f.add(t), p);
    };
    for (const Vec3d& p : {Vec3d{0.3, 0.7, 1.5}, {0.3, -0.7, -1.5}, {-2, 0.1, 0}, {-2, -0.1, 0.5}}) {
        const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi);
        const Rgba ball = at(TextureMapping::spherical, p), tube = at(TextureMapping::cylindrical, p),
                   plane = at(TextureMapping::planar, p), own = at(TextureMapping::uv, p);
        EXPECT_NEAR(ball[0], turn < 0 ? turn + 1 : turn, 1e-6);
        EXPECT_NEAR(ball[1], std::acos(p.z / length(p)) / std::numbers::pi, 1e-6);
        EXPECT_NEAR(tube[0], turn + 0.5, 1e-6);
        EXPECT_EQ(tube[1], float(p.z));
        EXPECT_EQ(plane[0], float(p.x));
        EXPECT_EQ(plane[1], float(p.y));
        EXPECT_EQ(own[0], 0);
        EXPECT_EQ(own[1], 0);
    }
}

TEST(Mapping, SpaceComesFirstAndTheMapOfUvLast)
{
    TextureFixture f;
    f.tables.texture_spaces = {{{{{0, 1, 0, 2}, {0, 0, 1, 3}, {1, 0, 0, 4}}}}};
    TextureRecord t = TextureFixture::of(TextureKind::coordinates);
    t.mapping = std::uint32_t(TextureMapping::planar), t.space = 0;
    t.uv_map = {0, 10, 1, 100, 0, 2};
    const Rgba c = f.at_place(f.add(t), {0.5, 0.25, 0.125});
    EXPECT_EQ(c[0], 10 * 3.125f + 1);
    EXPECT_EQ(c[1], 100 * 2.25f + 2);
    EXPECT_EQ(c[2], 0);
    EXPECT_EQ(c[3], 1);
}

/// A texture's operands use their own coordinates; only uv_transform passes its coordinates on.
TEST(Mapping, IsNotHandedOn)
{
    TextureFixture f;
    TextureRecord inner = TextureFixture::of(TextureKind::coordinates);
    const std::uint32_t own = f.add(inner);
    for (const TextureKind kind : {TextureKind::checker_uv, TextureKind::uv_transform}) {
        TextureRecord outer = TextureFixture::of(kind);
        outer.mapping = std::uint32_t(TextureMapping::planar);
        outer.color_a = {1, 1, 1, 1}, outer.texture_a = own;
        EXPECT_EQ(f.at_place(f.add(outer), {0.25, 0.5, 0})[1], kind == TextureKind::uv_transform ? 0.5f : 0);
    }
}

}  // namespace
}  // namespace fathom::test
