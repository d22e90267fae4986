// SPDX-License-Identifier: Apache-2.0
#include "image/projections/cube_map.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "fathom/vector.h"

namespace fathom {

namespace {

/// Each output pixel is the mean of `subsamples` by `subsamples` samples.
constexpr int subsamples = 4;

/// A point on the cube: its face, and the position from the face's upper left corner, in [0, 1].
struct FacePoint {
    std::size_t face;
    double s, t;
};

/// The face and position that a direction points at: OpenGL 4.6, table 8.19.
FacePoint face_point(const Vec3d& d)
{
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    const auto point = [](std::size_t face, double s, double t, double major) {
        return FacePoint{face, (s / major + 1) / 2, (t / major + 1) / 2};
    };
    if (x >= y && x >= z) return d.x > 0 ? point(0, -d.z, -d.y, x) : point(1, d.z, -d.y, x);
    if (y >= z) return d.y > 0 ? point(2, d.x, d.z, y) : point(3, d.x, -d.z, y);
    return d.z > 0 ? point(4, d.x, -d.y, z) : point(5, -d.x, -d.y, z);
}

const float* texel_at(const std::array<CubeFace, 6>& faces, const Vec3d& direction)
{
    const FacePoint at = face_point(direction);
    const CubeFace& face = faces[at.face];
    const auto place = [](double v, int size) { return std::size_t(std::clamp(int(v * size), 0, size - 1)); };
    return &face.texels[4 * (place(at.t, face.height) * std::size_t(face.width) + place(at.s, face.width))];
}

/// Sines and cosines of the centers of `count` equal parts of the interval [from, to].
std::vector<std::array<double, 2>> angles(int count, double from, double to)
{
    std::vector<std::array<double, 2>> list;
    for (int i = 0; i < count; ++i) {
        const double angle = from + (to - from) * (i + 0.5) / count;
        list.push_back({std::sin(angle), std::cos(angle)});
    }
    return list;
}

}  // namespace

int equirectangular_width(const std::array<CubeFace, 6>& faces)
{
    int side = 1;
    for (const CubeFace& face : faces) side = std::max({side, face.width, face.height});
    return 4 * side;
}

LargeVector<float> equirectangular(const std::array<CubeFace, 6>& faces)
{
    const int width = equirectangular_width(faces), height = width / 2;
    // The image's center is the direction +x, and its right half faces +z.
    const auto columns = angles(width * subsamples, -std::numbers::pi, std::numbers::pi);
    const auto rows = angles(height * subsamples, 0, std::numbers::pi);
    constexpr double min_alpha = 1.0 / 255;
    LargeVector<float> picture(std::size_t(width) * std::size_t(height) * 4, 1);
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            std::array<double, 3> sum{};
            for (int i = 0; i < subsamples * subsamples; ++i) {
                const int row = y * subsamples + i / subsamples, column = x * subsamples + i % subsamples;
                const auto [sin_theta, cos_theta] = rows[std::size_t(row)];
                const auto [sin_phi, cos_phi] = columns[std::size_t(column)];
                const float* texel = texel_at(faces, {sin_theta * cos_phi, cos_theta, sin_theta * sin_phi});
                for (std::size_t c = 0; c < 3; ++c) sum[c] += double(texel[c]) / std::max(double(texel[3]), min_alpha);
            }
            float* pixel = &picture[(std::size_t(y) * std::size_t(width) + std::size_t(x)) * 4];
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = float(sum[c] / (subsamples * subsamples));
        }
    });
    return picture;
}

}  // namespace fathom
