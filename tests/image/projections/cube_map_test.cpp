// SPDX-License-Identifier: Apache-2.0
#include "image/projections/cube_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fathom/vector.h"

namespace fathom {
namespace {

using Faces = std::array<CubeFace, 6>;

Faces black_faces(int size)
{
    Faces faces;
    for (CubeFace& face : faces) {
        face.width = face.height = size;
        for (int i = 0; i < size * size; ++i) face.texels.insert(face.texels.end(), {0, 0, 0, 1});
    }
    return faces;
}

/// Value of one channel in a direction.
float shown(const Faces& faces, const Vec3d& direction, std::size_t channel = 0)
{
    const Vec3d d = normalize(direction);
    const int width = equirectangular_width(faces), height = width / 2;
    const double u = std::atan2(d.z, d.x) / (2 * std::numbers::pi) + 0.5, v = std::acos(d.y) / std::numbers::pi;
    const int x = std::min(int(u * width), width - 1), y = std::min(int(v * height), height - 1);
    return equirectangular(faces)[std::size_t(y * width + x) * 4 + channel];
}

constexpr Vec3d axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

TEST(CubeMap, EachAxisShowsItsFace)
{
    Faces faces = black_faces(8);
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t k = 0; k < faces[i].texels.size(); k += 4) faces[i].texels[k + i % 3] = float(i + 1);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(shown(faces, axes[i], i % 3), float(i + 1)) << i;
}

/// The upper corners of each face have the directions in the figures of the OpenGL specification.
TEST(CubeMap, FacesAreTurnedAsInOpenGl)
{
    constexpr Vec3d left[] = {{1, 1, 1}, {-1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {-1, 1, 1}, {1, 1, -1}};
    constexpr Vec3d right[] = {{1, 1, -1}, {-1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, -1}};
    const int size = 16;
    for (std::size_t i = 0; i < 6; ++i) {
        Faces faces = black_faces(size);
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 4; ++x) {
                faces[i].texels[std::size_t(4 * (y * size + x))] = 1;
                faces[i].texels[std::size_t(4 * (y * size + size - 1 - x)) + 1] = 1;
            }
        const Vec3d to_left = left[i] * 0.85 + axes[i] * 0.15, to_right = right[i] * 0.85 + axes[i] * 0.15;
        EXPECT_EQ(shown(faces, to_left, 0), 1) << i;
        EXPECT_EQ(shown(faces, to_left, 1), 0) << i;
        EXPECT_EQ(shown(faces, to_right, 1), 1) << i;
        EXPECT_EQ(shown(faces, to_right, 0), 0) << i;
    }
}

/// Solid angle of the part of the face z = 1 between its center and (x, y).
double solid_angle_to(double x, double y)
{
    return std::atan2(x * y, std::sqrt(x * x + y * y + 1));
}

/// A patch of 8 x 8 texels emits in proportion to its solid angle, at a face's center and at its corner.
TEST(CubeMap, LightIsKept)
{
    const int size = 32, square = 8;
    for (const int place : {0, 5, 12}) {
        Faces faces = black_faces(size);
        for (int y = place; y < place + square; ++y)
            for (int x = place; x < place + square; ++x) faces[4].texels[std::size_t(4 * (y * size + x))] = 1;
        const auto picture = equirectangular(faces);
        const int width = equirectangular_width(faces), height = width / 2;
        double light = 0;
        for (int y = 0; y < height; ++y) {
            const double band = std::cos(std::numbers::pi * y / height) - std::cos(std::numbers::pi * (y + 1) / height);
            for (int x = 0; x < width; ++x)
                light += double(picture[std::size_t(y * width + x) * 4]) * band * 2 * std::numbers::pi / width;
        }
        const double a = 2.0 * place / size - 1, b = 2.0 * (place + square) / size - 1;
        const double expected =
            solid_angle_to(b, b) - solid_angle_to(a, b) - solid_angle_to(b, a) + solid_angle_to(a, a);
        // Texels of the result are at most a quarter of a face texel wide and lie inside or outside as a whole, which
        // gives an error of up to an eighth on either side.
        EXPECT_NEAR(light / expected, 1, 2 * 0.125 * 2 / square) << place;
    }
}

TEST(CubeMap, ColorsArePremultipliedByAlpha)
{
    Faces faces = black_faces(8);
    const auto fill = [](CubeFace& face, const std::array<float, 4>& texel) {
        for (std::size_t i = 0; i < face.texels.size(); ++i) face.texels[i] = texel[i % 4];
    };
    fill(faces[0], {0.5f, 0.25f, 1, 0.125f});
    fill(faces[1], {0.5f, 0, 0, 0});
    EXPECT_EQ(shown(faces, axes[0], 0), 4);
    EXPECT_EQ(shown(faces, axes[0], 2), 8);
    EXPECT_EQ(shown(faces, axes[0], 3), 1);
    EXPECT_NEAR(shown(faces, axes[1], 0), 127.5, 1e-4);
}

}  // namespace
}  // namespace fathom
