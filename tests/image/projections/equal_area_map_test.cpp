// SPDX-License-Identifier: Apache-2.0
#include "image/projections/equal_area_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fathom/vector.h"

namespace fathom {
namespace {

constexpr int size = 16;

/// An image that is black except for one texel.
CubeFace square_with(int x, int y)
{
    CubeFace square;
    square.width = square.height = size;
    for (int i = 0; i < size * size; ++i) {
        const float value = i == y * size + x ? 1 : 0;
        square.texels.insert(square.texels.end(), {value, value, value, 1});
    }
    return square;
}

struct Shown {
    Vec3d direction;
    double light;  ///< integral over the sphere
};

/// Mean direction and total amount of the image's light.
Shown shown(const CubeFace& square)
{
    const int width = equirectangular_width(square), height = width / 2;
    const LargeVector<float> picture = equirectangular_from_equal_area(square);
    Shown sum{};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double theta = (y + 0.5) / height * std::numbers::pi,
                         phi = ((x + 0.5) / width * 2 - 1) * std::numbers::pi;
            const double light = picture[std::size_t(y * width + x) * 4] * std::sin(theta) * 2 *
                                 std::pow(std::numbers::pi / height, 2) / 2;
            sum.light += light;
            sum.direction = sum.direction + light * Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta),
                                                          std::sin(theta) * std::sin(phi)};
        }
    sum.direction = normalize(sum.direction);
    return sum;
}

TEST(EqualAreaMap, AxesAreWherePbrtHasThem)
{
    // The equator maps to a square rotated by 45 degrees, so equatorial axes are at the midpoints of the edges.
    const std::pair<std::array<int, 2>, Vec3d> places[] = {{{8, 8}, {0, 0, 1}},  {{15, 8}, {1, 0, 0}},
                                                           {{8, 15}, {0, 1, 0}}, {{0, 8}, {-1, 0, 0}},
                                                           {{8, 0}, {0, -1, 0}}, {{0, 0}, {0, 0, -1}}};
    for (const auto& [texel, axis] : places)
        EXPECT_GT(dot(shown(square_with(texel[0], texel[1])).direction, axis), 0.93) << texel[0] << ' ' << texel[1];
}

TEST(EqualAreaMap, EachTexelHasItsShare)
{
    const double share = 4 * std::numbers::pi / (size * size);
    for (const auto& [x, y] : {std::pair{8, 8}, {12, 8}, {5, 5}, {10, 2}, {2, 13}})
        EXPECT_NEAR(shown(square_with(x, y)).light, share, 0.05 * share) << x << ' ' << y;
}

}  // namespace
}  // namespace fathom
