// SPDX-License-Identifier: Apache-2.0
#include "session/caustic_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace fathom {
namespace {

CausticPhoton photon(Vec3f position, std::uint32_t sample, std::uint32_t path)
{
    CausticPhoton p{};
    p.position = position, p.sample = sample, p.path = path;
    return p;
}

/// A square grid of photons on a plane, `distance` apart.
std::vector<CausticPhoton> grid(float distance, std::uint32_t sample = 0)
{
    std::vector<CausticPhoton> photons;
    for (std::uint32_t i = 0; i < 40; ++i)
        for (std::uint32_t k = 0; k < 40; ++k)
            photons.push_back(photon({float(i) * distance - 5, -2, float(k) * distance + 1}, sample, 40 * i + k));
    return photons;
}

bool is_same(const CausticMap& a, const CausticMap& b)
{
    return std::equal(a.photons.begin(), a.photons.end(), b.photons.begin(), b.photons.end(),
                      [](const CausticPhoton& p, const CausticPhoton& q) {
                          return p.sample == q.sample && p.path == q.path && p.bounces == q.bounces;
                      }) &&
           a.buckets == b.buckets;
}

TEST(CausticMap, FirstRadiusReachesTwelveNeighbors)
{
    // Within twice the distance of a grid's points are 12 others.
    EXPECT_FLOAT_EQ(first_caustic_radius(grid(0.25f), 1, 9), 0.5f);
    EXPECT_FLOAT_EQ(first_caustic_radius(grid(0.125f), 1, 9), 0.25f);
    // A sixteenth of them are of one sample.
    EXPECT_FLOAT_EQ(first_caustic_radius(grid(0.125f), 16, 9), 1);
}

TEST(CausticMap, FirstRadiusWithoutPhotons)
{
    EXPECT_EQ(first_caustic_radius({}, 1, 9), 9);
    std::vector<CausticPhoton> few = grid(1);
    few.resize(20);
    EXPECT_EQ(first_caustic_radius(few, 1, 9), 9);
    // Photons in one point have no distance.
    EXPECT_EQ(first_caustic_radius(std::vector<CausticPhoton>(100, photon({1, 2, 3}, 0, 0)), 1, 9), 9);
}

TEST(CausticMap, RadiiShrinkBySampleIndex)
{
    const CausticMap map = make_caustic_map({}, 63, 2, 0.5f);
    ASSERT_EQ(map.radii.size(), 2u);
    EXPECT_FLOAT_EQ(map.radii[0], 0.25f);  // 64^(-1/6) = 1/2
    EXPECT_FLOAT_EQ(map.radii[1], 0.5f * std::pow(65.f, -1.f / 6));
}

/// Every photon is in the bucket of its cell, and nowhere else.
TEST(CausticMap, BucketsHoldTheirCells)
{
    std::vector<CausticPhoton> photons = grid(0.07f, 5);
    const std::vector<CausticPhoton> more = grid(0.03f, 6);
    photons.insert(photons.end(), more.begin(), more.end());
    const CausticMap map = make_caustic_map(photons, 5, 2, 0.1f);
    ASSERT_EQ(map.photons.size(), photons.size());
    ASSERT_EQ(map.buckets.size(), std::size_t(map.bucket_mask) + 2);
    EXPECT_EQ(map.buckets.back(), photons.size());
    std::vector<int> seen(photons.size());
    for (std::size_t bucket = 0; bucket + 1 < map.buckets.size(); ++bucket)
        for (std::uint32_t i = map.buckets[bucket]; i < map.buckets[bucket + 1]; ++i) {
            const CausticPhoton& p = map.photons[i];
            const float inverse = 0.5f / map.radii[p.sample - 5];
            const auto cell = [&](float x) { return std::bit_cast<std::uint32_t>(std::floor(x * inverse) + 0.f); };
            const std::uint32_t hash =
                caustic_cell_hash(cell(p.position.x), cell(p.position.y), cell(p.position.z), p.sample);
            EXPECT_EQ(hash & map.bucket_mask, bucket);
            ++seen[(p.sample - 5) * 1600 + p.path];
        }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), std::ptrdiff_t(seen.size()));
}

TEST(CausticMap, DoesNotDependOnTheOrderOfTracing)
{
    std::vector<CausticPhoton> photons = grid(0.07f, 0);
    const CausticMap map = make_caustic_map(photons, 0, 1, 0.1f);
    const float radius = first_caustic_radius(photons, 1, 9);
    std::shuffle(photons.begin(), photons.end(), std::mt19937(7));
    EXPECT_TRUE(is_same(make_caustic_map(photons, 0, 1, 0.1f), map));
    EXPECT_EQ(first_caustic_radius(photons, 1, 9), radius);
}

}  // namespace
}  // namespace fathom
