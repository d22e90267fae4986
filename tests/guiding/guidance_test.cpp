// SPDX-License-Identifier: Apache-2.0
#include "guiding/guidance.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "support/chi_square.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

/// Tables of two cells along x; in the first, every side has a region with a random histogram.
GuidingTables some_tables(unsigned seed)
{
    GuidingTables t;
    t.cells[0] = 2, t.cells[1] = t.cells[2] = 1;
    t.inverse_cell = 1;
    t.regions.assign(2 * guiding_sides, no_index);
    std::mt19937 engine(seed);
    for (std::uint32_t side = 0; side < guiding_sides; ++side) {
        t.regions[side] = side;
        std::vector<double> weights(guiding_bins);
        double total = 0, sum = 0;
        // Some bins are empty.
        for (double& w : weights) total += w = double(engine() % 4 == 0 ? 0 : engine() % 1000);
        for (double w : weights) {
            t.histograms.push_back(float(sum / total));
            sum += w;
        }
        t.histograms.push_back(1);
        t.survival_factors.push_back(float(side));
        t.shares.push_back(0.1f * float(side));
    }
    return t;
}

const Vec3f normals[] = {{1, 0.3f, -0.2f}, {-1, 0.1f, 0.9f}, {0.2f, 1, 0}, {0, -1, 0.5f}, {0.4f, 0.2f, 1}, {0, 0, -1}};
const Vec3 middle(Vec3f{0.5f, 0.5f, 0.5f}), no_shift(Vec3f{0.5f, 0.5f, 0.5f});

Guidance guidance_of(const GuidingTables& t, const Vec3& p, const Vec3f& n, float weight = 1)
{
    return {t, p, Vec3(n), no_shift, Float(weight), Mask(true)};
}

TEST(Guidance, SamplesByItsDensity)
{
    const GuidingTables t = some_tables(1);
    std::mt19937 engine(2);
    const auto number = [&] { return Float(float(engine() >> 8) * 0x1p-24f); };
    for (const Vec3f& n : normals) {
        const Guidance g = guidance_of(t, middle, n);
        std::vector<test::Direction> samples;
        for (int i = 0; i < 100000; ++i) {
            const Vec3 d = g.sample({number(), number()});
            samples.push_back({test::first(d.x), test::first(d.y), test::first(d.z)});
        }
        const auto pdf = [&](test::Direction d) {
            return double(test::first(g.histogram_pdf(Vec3(Vec3f{float(d.x), float(d.y), float(d.z)}))));
        };
        EXPECT_EQ(test::chi_square_directions(samples, pdf), "");
        EXPECT_NEAR(test::integrate_sphere(pdf), 1, 5e-3);
    }
}

/// Sampled directions fall into bins that are not empty.
TEST(Guidance, FindsWhatItSamples)
{
    const GuidingTables t = some_tables(3);
    for (const Vec3f& n : normals) {
        const Guidance g = guidance_of(t, middle, n);
        for (int i = 0; i < 4096; ++i) {
            const Float u((float(i) + 0.5f) / 4096), v(float(i * 37 % 4096) / 4096 + 1e-4f);
            EXPECT_GT(test::first(g.histogram_pdf(g.sample({u, v}))), 0);
        }
    }
}

TEST(Guidance, KnowsTheSideThatASurfaceFaces)
{
    const GuidingTables t = some_tables(4);
    for (std::uint32_t side = 0; side < guiding_sides; ++side) {
        EXPECT_EQ(test::first(guiding_side(Vec3(normals[side]))), side);
        EXPECT_EQ(test::first(guidance_of(t, middle, normals[side]).survival_factor()), float(side));
        // The pole is the side's direction, and from_histogram_frame() inverts to_histogram_frame().
        const Vec3 d(Vec3f{0.36f, -0.48f, 0.8f});
        const Vec3 again = from_histogram_frame(UInt(side), to_histogram_frame(UInt(side), d));
        EXPECT_EQ(test::first(again.x), 0.36f);
        EXPECT_EQ(test::first(again.y), -0.48f);
        EXPECT_EQ(test::first(again.z), 0.8f);
        EXPECT_GT(test::first(to_histogram_frame(UInt(side), Vec3(normals[side])).z), 0.7f);
    }
}

/// Without guiding data the density is that of the closure. The share is that of the region, and smaller for closures
/// that can be guided less.
TEST(Guidance, SharesDirectionsWithTheClosure)
{
    const GuidingTables t = some_tables(5);
    const Vec3 beyond(Vec3f{1.5f, 0.5f, 0.5f}), d(Vec3f{0.36f, -0.48f, 0.8f});
    const Guidance unknown = guidance_of(t, beyond, normals[0]);
    EXPECT_FALSE(any(unknown.known()));
    EXPECT_EQ(test::first(unknown.share()), 0);
    EXPECT_EQ(test::first(unknown.pdf(d, Float(0.7f))), 0.7f);
    const Guidance most = guidance_of(t, middle, normals[4], 1), half = guidance_of(t, middle, normals[4], 0.5f);
    EXPECT_FLOAT_EQ(test::first(most.share()), 0.4f);
    EXPECT_FLOAT_EQ(test::first(half.share()), 0.2f);
    const float own = test::first(most.histogram_pdf(d));
    EXPECT_NEAR(test::first(most.pdf(d, Float(0.7f))), 0.4f * own + 0.42f, 1e-6f);
    EXPECT_NEAR(test::first(half.pdf(d, Float(0.7f))), 0.2f * own + 0.56f, 1e-6f);
}

/// Positions outside the grid use the nearest cell; positions are jittered by up to half a cell.
TEST(Guidance, FindsTheCube)
{
    GuidingTables t = some_tables(6);
    for (std::uint32_t side = 0; side < guiding_sides; ++side)
        t.regions[guiding_sides + side] = guiding_sides - 1 - side;
    const auto need_at = [&](Vec3f p, Vec3f shift) {
        return test::first(Guidance(t, Vec3(p), Vec3(normals[1]), Vec3(shift), Float(1), Mask(true)).survival_factor());
    };
    EXPECT_EQ(need_at({0.1f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}), 1);
    EXPECT_EQ(need_at({-7, 9, -9}, {0.5f, 0.5f, 0.5f}), 1);
    EXPECT_EQ(need_at({1.2f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}), 4);
    EXPECT_EQ(need_at({99, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}), 4);
    EXPECT_EQ(need_at({0.8f, 0.5f, 0.5f}, {0.9f, 0.5f, 0.5f}), 4);
    EXPECT_EQ(need_at({1.2f, 0.5f, 0.5f}, {0.1f, 0.5f, 0.5f}), 1);
}

/// Learning (scalar) and rendering (lanes) find the same cell. Positions are multiples of 1/64, so nothing is rounded.
TEST(Guidance, LanesFindTheCubeThatLearningFinds)
{
    GuidingTables t;
    t.lowest[0] = -2, t.lowest[1] = 1, t.lowest[2] = 0.5f;
    t.inverse_cell = 2;
    t.cells[0] = 5, t.cells[1] = 3, t.cells[2] = 4;
    std::mt19937 engine(7);
    std::set<std::size_t> met;
    for (int i = 0; i < 4096; ++i) {
        float p[3][lanes], noise[3][lanes];
        for (int k = 0; k < 3; ++k)
            for (int lane = 0; lane < lanes; ++lane) {
                p[k][lane] = t.lowest[k] + (float(engine() % 256) - 64) / 64;
                noise[k][lane] = float(engine() % 16) / 16;
            }
        std::uint32_t cubes[lanes], moved[lanes];
        const Vec3 at{load(p[0]), load(p[1]), load(p[2])};
        store(cubes, guiding_cube(t, at, no_shift));
        store(moved, guiding_cube(t, at, {load(noise[0]), load(noise[1]), load(noise[2])}));
        for (int lane = 0; lane < lanes; ++lane) {
            float place[3], there[3];
            for (int k = 0; k < 3; ++k) {
                place[k] = p[k][lane];
                there[k] = place[k] + (noise[k][lane] - 0.5f) / t.inverse_cell;
            }
            ASSERT_EQ(cubes[lane], guiding_cube(t, place)) << place[0] << " " << place[1] << " " << place[2];
            ASSERT_EQ(moved[lane], guiding_cube(t, there)) << there[0] << " " << there[1] << " " << there[2];
            met.insert(cubes[lane]);
        }
    }
    EXPECT_EQ(met.size(), 5u * 3u * 4u);
    EXPECT_EQ(*met.rbegin(), 5u * 3u * 4u - 1u);
}

/// The probability of NEE is nee_factor times throughput, clamped to [1/8, 1].
TEST(Guidance, LightSampleProbabilitiesAreInRange)
{
    GuidingTables t = some_tables(8);
    for (float need : {0.0f, 0.25f, 2.0f, 1e30f}) t.nee_factors.push_back(need);
    const auto chance = [&](std::uint32_t cube, float throughput) {
        return test::first(nee_probability(t, UInt(cube), Float(throughput), Mask(true)));
    };
    EXPECT_EQ(chance(0, 1), 0.125f);
    EXPECT_EQ(chance(1, 0), 0.125f);
    EXPECT_EQ(chance(1, 0.25f), 0.125f);
    EXPECT_EQ(chance(1, 1), 0.25f);
    EXPECT_EQ(chance(1, 3), 0.75f);
    EXPECT_EQ(chance(1, 5), 1);
    EXPECT_EQ(chance(2, 0.25f), 0.5f);
    EXPECT_EQ(chance(2, 1), 1);
    EXPECT_EQ(chance(3, 0.5f), 1);
    // Inactive lanes read nothing, whatever their cell index is.
    EXPECT_EQ(test::first(nee_probability(t, UInt(0xfffffff0u), Float(1), Mask(false))), 0.125f);
}

}  // namespace
}  // namespace fathom
