// SPDX-License-Identifier: Apache-2.0
#include "image/projections/equal_area_map.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fathom/vector.h"

namespace fathom {

namespace {

struct SquarePoint {
    double u, v;
};

SquarePoint square_point(const Vec3d& d)
{
    // Here r is the distance from the pole in the square; the azimuth divides it between u and v.
    const double x = std::abs(d.x), y = std::abs(d.y), r = std::sqrt(std::max(0.0, 1 - std::abs(d.z)));
    double v = r * std::atan2(y, x) * 2 / std::numbers::pi, u = r - v;
    if (d.z < 0) {
        std::swap(u, v);
        u = 1 - u, v = 1 - v;
    }
    return {(std::copysign(u, d.x) + 1) / 2, (std::copysign(v, d.y) + 1) / 2};
}

/// A texel, with coordinates beyond an edge wrapped: the map continues at the same edge, mirrored about its midpoint.
const float* texel(const CubeFace& square, int x, int y)
{
    const int w = square.width, h = square.height;
    if (x < 0 || x >= w) {
        x = std::clamp(x, 0, w - 1);
        y = h - 1 - std::clamp(y, 0, h - 1);
    }
    if (y < 0 || y >= h) {
        y = std::clamp(y, 0, h - 1);
        x = w - 1 - x;
    }
    return &square.texels[4 * (std::size_t(y) * std::size_t(w) + std::size_t(x))];
}

std::array<double, 3> looked_up(const CubeFace& square, const Vec3d& d)
{
    const SquarePoint at = square_point(d);
    const double x = at.u * square.width - 0.5, y = at.v * square.height - 0.5;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    std::array<double, 3> sum{};
    for (int k = 0; k < 4; ++k) {
        const double weight = (k & 1 ? x - x0 : 1 - (x - x0)) * (k & 2 ? y - y0 : 1 - (y - y0));
        const float* const t = texel(square, x0 + (k & 1), y0 + (k >> 1));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * double(t[c]);
    }
    return sum;
}

}  // namespace

LargeVector<float> equirectangular_from_equal_area(const CubeFace& square)
{
    constexpr int subpixels = 3;  // subpixels along each axis of an output pixel
    const int width = equirectangular_width(square), height = square.width;
    LargeVector<float> picture(std::size_t(width) * std::size_t(height) * 4, 1);
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            std::array<double, 3> sum{};
            for (int i = 0; i < subpixels * subpixels; ++i) {
                const int row = i / subpixels, column = i % subpixels;
                const double theta = (y + (row + 0.5) / subpixels) / height * std::numbers::pi,
                             phi = ((x + (column + 0.5) / subpixels) / width * 2 - 1) * std::numbers::pi;
                const Vec3d d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
                const std::array<double, 3> value = looked_up(square, d);
                for (std::size_t c = 0; c < 3; ++c) sum[c] += value[c];
            }
            for (std::size_t c = 0; c < 3; ++c)
                picture[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x)) + c] =
                    float(sum[c] / (subpixels * subpixels));
        }
    });
    return picture;
}

}  // namespace fathom
