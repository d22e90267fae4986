// SPDX-License-Identifier: Apache-2.0
#include "textures/patterns.h"

#include <set>

#include "texture_checks.h"

namespace fathom::test {
namespace {

/// Cells from -2 to 2 are those with a dot in pbrt-v4, and some dots have its centers.
TEST(DotsTexture, MatchPbrt)
{
    const std::set<std::pair<int, int>> cells = {{-2, -2}, {-1, -1}, {-1, 2}, {0, 1},  {0, 2}, {1, -2},
                                                 {1, -1},  {1, 2},   {2, -2}, {2, -1}, {2, 2}};
    TextureFixture f;
    TextureRecord t = TextureFixture::of(TextureKind::dots);
    t.scale = 2;
    const std::uint32_t dots = f.add(t);
    const auto is_dot = [&](double u, double v) { return f.at(dots, float(u / 2), float(v / 2))[0] == 1; };
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j) EXPECT_EQ(is_dot(i, j), cells.contains({i, j})) << i << ' ' << j;
    for (const auto& [x, y] : {std::pair{1.113152, 2.011902}, {-1.065545, 2.038803}, {1.990647, -0.915213}})
        for (int side = 0; side < 8; ++side) {
            const double a = side * 0.7853981633974483, c = std::cos(a), s = std::sin(a);
            EXPECT_TRUE(is_dot(x + 0.3495 * c, y + 0.3495 * s));
            EXPECT_FALSE(is_dot(x + 0.3505 * c, y + 0.3505 * s));
        }
}

}  // namespace
}  // namespace fathom::test
