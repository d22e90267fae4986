// SPDX-License-Identifier: Apache-2.0
#include "textures/uv_transform.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

TEST(UvTransformTexture, MovesWhatItRefersTo)
{
    TextureFixture f;
    TextureRecord checker = TextureFixture::of(TextureKind::checker_uv);
    TextureRecord moved = TextureFixture::of(TextureKind::uv_transform);
    moved.color_a = {0.5f, 1, 1, 1};
    moved.texture_a = f.add(checker);
    // u' = 2 v + 0.25, v' = u - 3.
    moved.uv_map = {0, 2, 0.25f, 1, 0, -3};
    const std::uint32_t texture = f.add(moved);
    for (const auto& [u, v] : {std::pair{0.1f, 0.2f}, {0.6f, 0.45f}, {1.2f, 0.1f}, {3.5f, 1.9f}}) {
        const int cell = int(std::floor(2 * v + 0.25f)) + int(std::floor(u - 3));
        EXPECT_FLOAT_EQ(f.at(texture, u, v)[0], cell % 2 == 0 ? 0 : 0.5f) << u << ' ' << v;
    }
}

}  // namespace
}  // namespace fathom::test
