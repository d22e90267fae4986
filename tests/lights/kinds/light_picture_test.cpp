// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lights/kinds/picture.h"
#include "support/chi_square.h"
#include "support/lane_helpers.h"

// Tests of the lookup in light images, without lights.
namespace fathom {
namespace {

using test::first;

/// One image stored after a few texels of another.
LightTables tables_of(LightPictureMap map, int width, int height, const std::vector<float>& grays)
{
    LightTables tables;
    LightPictureRecord record;
    record.map = std::uint32_t(map);
    record.first = 3;
    record.width = float(width), record.height = float(height);
    record.scale_u = record.scale_v = 1;
    tables.light_pictures = {{}, record};
    tables.picture_texels.assign(12, 99.f);
    for (const float gray : grays)
        for (const float v : {gray, 2 * gray, 3 * gray, 1.f}) tables.picture_texels.push_back(v);
    return tables;
}

float look_up(const LightTables& tables, Vec3d d, int channel = 0)
{
    d = normalize(d);
    return first(light_picture(tables, UInt(1u), Float(float(d.x)), Float(float(d.y)), Float(float(d.z)), Mask(true))
                     .c[channel]);
}

Vec3d random_direction(test::Random& random)
{
    const double z = 1 - 2 * double(first(random.next())), phi = 2 * std::numbers::pi * double(first(random.next()));
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// Each texel of an equal-area image covers an equal solid angle.
TEST(LightImage, EqualAreas)
{
    std::vector<float> numbers;
    for (int i = 0; i < 36; ++i) numbers.push_back(float(i));
    LightTables tables = tables_of(LightPictureMap::equal_area, 6, 6, numbers);
    tables.light_pictures[1].flags = LightPictureRecord::nearest;
    test::Random random(7);
    constexpr int drawn = 40000;
    std::vector<double> observed(36), expected(36, drawn / 36.0);
    for (int i = 0; i < drawn; ++i) ++observed[std::size_t(std::lround(look_up(tables, random_direction(random))))];
    EXPECT_EQ(test::chi_square(observed, expected), "");
}

/// The axis is at the center, its opposite at all corners, right and top at the corresponding edges.
TEST(LightImage, EqualAreaPlaces)
{
    std::vector<float> numbers;
    for (int i = 0; i < 25; ++i) numbers.push_back(float(i));
    LightTables tables = tables_of(LightPictureMap::equal_area, 5, 5, numbers);
    EXPECT_NEAR(look_up(tables, {0, 0, 1}), 12, 1e-5);
    EXPECT_NEAR(look_up(tables, {0, 0, 1}, 2), 36, 1e-5);
    // The point is halfway between the center of the edge's texel and its mirror image, which is the same texel.
    EXPECT_NEAR(look_up(tables, {1, 0, 0}), 14, 1e-4);
    EXPECT_NEAR(look_up(tables, {-1, 0, 0}), 10, 1e-4);
    EXPECT_NEAR(look_up(tables, {0, 1, 0}), 2, 1e-4);
    EXPECT_NEAR(look_up(tables, {0, -1, 0}), 22, 1e-4);
    EXPECT_NEAR(look_up(tables, {0, 0, -1}), 12, 1e-3);  // the mean of the four corners
    tables.light_pictures[1].flags = LightPictureRecord::nearest;
    EXPECT_EQ(look_up(tables, {1, 1, -4}), 4);
    EXPECT_EQ(look_up(tables, {-1, -1, -4}), 20);
    EXPECT_EQ(look_up(tables, {-1, 1, -4}), 0);
}

/// Lookup is continuous: nearby directions give nearly equal values across all edges.
TEST(LightImage, EqualAreaEdgesMeet)
{
    test::Random random(3);
    std::vector<float> values;
    for (int i = 0; i < 16; ++i) values.push_back(first(random.next()));
    const LightTables tables = tables_of(LightPictureMap::equal_area, 4, 4, values);
    for (int i = 0; i < 4000; ++i) {
        Vec3d d = random_direction(random);
        // Every other direction is near the image's edges: behind, in a plane through the axis and x or y.
        if (i % 2) (i % 4 == 1 ? d.x : d.y) *= 1e-4, d.z = -std::abs(d.z);
        d = normalize(d);
        const Vec3d near = d + random_direction(random) * 3e-4;
        EXPECT_NEAR(look_up(tables, d), look_up(tables, near), 6e-3) << d.x << ' ' << d.y << ' ' << d.z;
    }
}

/// A window of 2 x 2 texels has the expected values between texels, at the edges, and outside.
TEST(LightImage, PlaneIsAWindow)
{
    LightTables tables = tables_of(LightPictureMap::plane, 2, 2, {1, 2, 3, 4});
    tables.light_pictures[1].scale_u = 2;    // the window is half as wide as it is far away
    tables.light_pictures[1].scale_v = 0.5;  // the window is twice as high as it is far away
    EXPECT_NEAR(look_up(tables, {0, 0, 1}), 2.5, 1e-6);
    EXPECT_NEAR(look_up(tables, {-0.25, 1, 1}), 1, 1e-6);
    EXPECT_NEAR(look_up(tables, {0.25, 1, 1}), 2, 1e-6);
    EXPECT_NEAR(look_up(tables, {0.25, 1, 1}, 1), 4, 1e-6);
    EXPECT_NEAR(look_up(tables, {-0.25, -1, 1}), 3, 1e-6);
    EXPECT_NEAR(look_up(tables, {0.125, 0, 1}), 2.75, 1e-6);
    EXPECT_NEAR(look_up(tables, {0.499, -1.99, 1}), 4, 1e-6);
    for (const Vec3d& outside :
         {Vec3d{0.501, 0, 1}, {-0.501, 0, 1}, {0, 2.01, 1}, {0, -2.01, 1}, {0, 0, -1}, {1, 0, 0}, {0.1, 0.1, -1}})
        EXPECT_EQ(look_up(tables, outside), 0) << outside.x << ' ' << outside.y << ' ' << outside.z;
    tables.light_pictures[1].flags = LightPictureRecord::flat_field;
    EXPECT_NEAR(look_up(tables, {0.25, 1, 1}), 2 * std::pow(1 + 0.0625 + 1, 1.5), 1e-5);
    EXPECT_NEAR(look_up(tables, {0, 0, 1}), 2.5, 1e-6);
    tables.light_pictures[1].flags = LightPictureRecord::nearest;
    EXPECT_EQ(look_up(tables, {0.01, 0.02, 1}), 2);
    EXPECT_EQ(look_up(tables, {-0.01, -0.02, 1}), 3);
}

/// Rows are from 30 to 90 degrees; columns are at every quarter turn, counterclockwise as seen against the emission
/// direction.
TEST(LightImage, AnglesHaveTheirValues)
{
    LightTables tables = tables_of(LightPictureMap::angles, 4, 3, {1, 2, 3, 4, 10, 20, 30, 40, 100, 200, 300, 400});
    LightPictureRecord& record = tables.light_pictures[1];
    constexpr double degree = std::numbers::pi / 180;
    record.start = float(30 * degree);
    record.scale_u = float(4 / (2 * std::numbers::pi)), record.scale_v = float(1 / (30 * degree));
    const auto at = [&](double polar, double azimuth) {
        polar *= degree, azimuth *= degree;
        return double(look_up(
            tables, {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)}));
    };
    EXPECT_NEAR(at(30, 0), 1, 1e-4);
    EXPECT_NEAR(at(60, 90), 20, 1e-4);
    EXPECT_NEAR(at(60, 270), 40, 1e-4);
    EXPECT_NEAR(at(90, 180), 300, 1e-3);
    EXPECT_NEAR(at(75, 180), 165, 1e-3);
    EXPECT_NEAR(at(60, 45), 15, 1e-4);
    EXPECT_NEAR(at(60, 315), 25, 1e-4);  // between the last column and the first
    EXPECT_NEAR(at(60, 359.99), 10, 1e-2);
    EXPECT_EQ(at(29.9, 0), 0);
    EXPECT_EQ(at(0, 0), 0);
    EXPECT_EQ(at(90.1, 0), 0);
    EXPECT_EQ(at(180, 0), 0);
    // A rotationally symmetric profile has one column.
    LightTables round = tables_of(LightPictureMap::angles, 1, 2, {8, 4});
    round.light_pictures[1].scale_u = float(1 / (2 * std::numbers::pi));
    round.light_pictures[1].scale_v = float(1 / std::numbers::pi);
    for (const Vec3d& d : {Vec3d{1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0.3, 0.4, 0}})
        EXPECT_NEAR(look_up(round, d), 6, 1e-5);
    EXPECT_NEAR(look_up(round, {0, 0, 1}), 8, 1e-5);
    EXPECT_NEAR(look_up(round, {0, 0, -1}), 4, 1e-5);
}

/// Lanes use images of different kinds and sizes at once.
TEST(LightImage, LanesDiffer)
{
    LightTables tables = tables_of(LightPictureMap::plane, 1, 1, {5});
    LightTables square = tables_of(LightPictureMap::equal_area, 2, 2, {7, 7, 7, 7});
    square.light_pictures[1].first = std::uint32_t(tables.picture_texels.size() / 4) + 3;
    tables.light_pictures.push_back(square.light_pictures[1]);
    tables.picture_texels.insert(tables.picture_texels.end(), square.picture_texels.begin(),
                                 square.picture_texels.end());
    float along[lanes];
    std::uint32_t picture[lanes];
    for (int i = 0; i < lanes; ++i) along[i] = i % 3 == 2 ? -1.f : 1.f, picture[i] = 1 + std::uint32_t(i % 2);
    const Spectrum s = light_picture(tables, load(picture), Float(0), Float(0), load(along), Mask(true));
    float values[lanes];
    store(values, s.c[0]);
    for (int i = 0; i < lanes; ++i) EXPECT_NEAR(values[i], i % 2 ? 7 : i % 3 == 2 ? 0 : 5, 1e-5) << i;
}

}  // namespace
}  // namespace fathom
