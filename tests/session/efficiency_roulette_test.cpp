// SPDX-License-Identifier: Apache-2.0
#include "session/efficiency_roulette.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fathom {
namespace {

/// Tables of guiding cells of edge 1 along x.
GuidingTables row_of_cubes(std::uint32_t count)
{
    GuidingTables t;
    t.cells[0] = count, t.cells[1] = t.cells[2] = 1;
    t.inverse_cell = 1;
    return t;
}

GuidingRecord surface(float x, float light)
{
    GuidingRecord r{{x, 0.5f, 0.5f}};
    r.light = light;
    return r;
}

/// Guiding records of paths, given the surfaces of each path.
GuidingRecords part_of(const std::vector<std::vector<GuidingRecord>>& paths)
{
    GuidingRecords part;
    for (const std::vector<GuidingRecord>& path : paths) {
        part.surfaces.insert(part.surfaces.end(), path.begin(), path.end());
        part.counts.push_back(std::uint8_t(path.size()));
    }
    return part;
}

/// Statistics of the paths of one part.
PathStatistics path_statistics(const GuidingRecords& part, const double* squares, std::size_t samples, double vertices,
                               double variance)
{
    PathStatistics met;
    met.parts = {{&part, squares}};
    met.samples = samples;
    met.vertices = vertices, met.variance = variance;
    return met;
}

/// Two paths for each of two pixels; the second pixel is a quarter as bright.
TEST(NeeFactors, CompareContributionsWithPixels)
{
    const GuidingRecords first = part_of({{surface(0.5f, 2), surface(1.5f, 0)}, {surface(0.2f, 4)}, {}}),
                         second = part_of({{surface(1.9f, 1)}});
    const double squares[] = {4, 0.25};
    PathStatistics met;
    met.parts = {{&first, &squares[0]}, {&second, &squares[1]}};
    met.samples = 2;
    met.vertices = 3, met.variance = 2;
    GuidingTables t = row_of_cubes(3);
    set_nee_factors(met, t);
    // The ratio is squared contribution over squared brightness: 4 / 4 + 16 / 4 = 5 in the first cell, 1 / 0.25 = 4 in
    // the second, with two samples each; the mean 9 / 4 has the weight of 32 samples. A light sample costs a quarter of
    // a vertex: 3 / (2 * 0.25) = 6.
    ASSERT_EQ(t.nee_factors.size(), 3u);
    EXPECT_FLOAT_EQ(t.nee_factors[0], float(1.5 * std::sqrt((5 + 72) / 34.0 * 6)));
    EXPECT_FLOAT_EQ(t.nee_factors[1], float(1.5 * std::sqrt((4 + 72) / 34.0 * 6)));
    EXPECT_FLOAT_EQ(t.nee_factors[2], float(1.5 * std::sqrt(2.25 * 6)));
}

/// With many samples only the cell counts, by the root of the squared contribution over the variance of paths.
TEST(NeeFactors, AreLookedUpByCube)
{
    const std::size_t paths = 200'000;
    std::vector<std::vector<GuidingRecord>> bright(paths, {surface(0.5f, 0.4f)}), dark(paths, {surface(1.5f, 0.01f)});
    const GuidingRecords first = part_of(bright), second = part_of(dark);
    const std::vector<double> squares(paths / 4, 1);
    PathStatistics met;
    met.parts = {{&first, squares.data()}, {&second, squares.data()}};
    met.samples = 4;
    met.vertices = 4, met.variance = 16;
    GuidingTables t = row_of_cubes(2);
    set_nee_factors(met, t);
    EXPECT_NEAR(t.nee_factors[0], 1.5 * 0.4, 1e-3);
    EXPECT_NEAR(t.nee_factors[1], 1.5 * 0.01, 2e-3);
}

/// Many parts are distributed over threads; each path stays with its own pixel.
TEST(NeeFactors, CompareSurvivalWithPixels)
{
    std::vector<GuidingRecords> parts(37);
    std::vector<double> squares(parts.size());
    PathStatistics met;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        // All pixels are as bright as their samples' contributions, so all ratios are equal.
        const float light = float(1 + i);
        parts[i] = part_of({{surface(0.5f, light)}, {}, {surface(0.5f, light), surface(0.5f, light)}});
        squares[i] = double(light) * double(light);
        met.parts.push_back({&parts[i], &squares[i]});
    }
    met.samples = 3;
    met.vertices = 1, met.variance = 4;
    GuidingTables t = row_of_cubes(1);
    set_nee_factors(met, t);
    EXPECT_FLOAT_EQ(t.nee_factors[0], 1.5f);
}

/// Records without information give finite factors.
TEST(NeeFactors, AreFinite)
{
    const GuidingRecords some = part_of({{surface(0.5f, 1)}}), none = part_of({{}});
    const auto need = [](const GuidingRecords& part, double square, double variance) {
        GuidingTables t = row_of_cubes(1);
        set_nee_factors(path_statistics(part, &square, 1, 1, variance), t);
        return t.nee_factors[0];
    };
    EXPECT_FLOAT_EQ(need(some, 1, 4), 1.5f);
    EXPECT_EQ(need(none, 1, 4), 0);
    EXPECT_EQ(need(some, 0, 4), 0);
    EXPECT_EQ(need(some, 1, 0), 0);
    EXPECT_FLOAT_EQ(need(some, 1e-300, 1e-6), 1e30f);
}

/// Factors of shadow rays are relative to a sample's contribution, so they depend on the brightness of the pixels that
/// see the cell.
TEST(ShadowRayFactors, CompareShadowRaysWithPixels)
{
    const GuidingRecords part = part_of({{surface(0.5f, 2), surface(1.5f, 0)}, {surface(0.2f, 4), surface(0.1f, 0)}});
    const double squares[] = {4, 0.25};
    GuidingTables t = row_of_cubes(3);
    set_shadow_ray_factors(path_statistics(part, squares, 1, 3, 2), t);
    // The sums are 1 / 4 + 2 * 4 in the first cell and 1 / 4 in the second; the mean 8.5 / 4 has the weight of 32
    // samples. A shadow ray costs a fifth of a vertex, and a quarter are assumed unoccluded: 0.25 * 3 / (2 * 0.2) =
    // 1.875.
    ASSERT_EQ(t.shadow_ray_factors.size(), 3u);
    EXPECT_FLOAT_EQ(t.shadow_ray_factors[0], float(std::sqrt((8.25 + 68) / 35.0 * 1.875)));
    EXPECT_FLOAT_EQ(t.shadow_ray_factors[1], float(std::sqrt((0.25 + 68) / 33.0 * 1.875)));
    EXPECT_FLOAT_EQ(t.shadow_ray_factors[2], float(std::sqrt(8.5 / 4 * 1.875)));
}

/// Record of a surface at which the path continued.
GuidingRecord continued_surface(float x, std::uint8_t side, float contribution, float throughput = 1)
{
    GuidingRecord r{{x, 0.5f, 0.5f}, side};
    r.bin = 0;
    r.contribution = contribution, r.throughput = throughput;
    return r;
}

/// Tables with a region of side 0 in each cell.
GuidingTables row_of_regions(std::uint32_t count)
{
    GuidingTables t = row_of_cubes(count);
    t.regions.assign(std::size_t(count) * guiding_sides, no_index);
    for (std::uint32_t i = 0; i < count; ++i) t.regions[std::size_t(i) * guiding_sides] = i;
    t.histograms.resize(std::size_t(count) * guiding_stride);
    return t;
}

/// A path's contribution counts relative to its throughput and its pixel, and per later vertex.
TEST(SurvivalFactors, WeighContributionByCost)
{
    // The last surfaces of two paths have no continuation; other sides and cells without data are ignored.
    const GuidingRecords part =
        part_of({{continued_surface(0.5f, 0, 2), surface(2.5f, 9), surface(2.5f, 9)},
                 {continued_surface(0.5f, 0, 3, 0.5f)},
                 {continued_surface(0.5f, 3, 50), continued_surface(2.5f, 0, 1), surface(0.5f, 9)}});
    const double squares[] = {4, 9, 0.25};
    GuidingTables t = row_of_regions(4);
    set_survival_factors(path_statistics(part, squares, 1, 3.5, 8), t);
    ASSERT_EQ(t.survival_factors.size(), 4u);
    // The ratio is squared contribution over squared brightness: 4 / 4 + 36 / 9 = 5 for 2.5 + 0.5 vertices; a whole
    // path costs 3.5 + 0.5.
    EXPECT_FLOAT_EQ(t.survival_factors[0], float(std::sqrt(5 / 3.0 * 4 / 8)));
    // The third path adds 1 / 0.25 for a cost of 1 + 0.5 vertices.
    EXPECT_FLOAT_EQ(t.survival_factors[2], float(std::sqrt(4 / 1.5 * 4 / 8)));
    // The fourth cell, in a block with the third, has no records, so paths always survive there.
    EXPECT_GE(t.survival_factors[3], 1e10f);
}

/// Cells of a block share half of their statistics, record by record.
TEST(SurvivalFactors, AreShared)
{
    const GuidingRecords part = part_of({{continued_surface(0.5f, 0, 2)},
                                         {continued_surface(0.5f, 0, 2)},
                                         {continued_surface(0.5f, 0, 2)},
                                         {continued_surface(1.5f, 0, 0)}});
    const double squares[] = {1};
    GuidingTables t = row_of_regions(2);
    set_survival_factors(path_statistics(part, squares, 4, 0.5, 1), t);
    // All four have a mean square of 3 for half a vertex each, while a path costs one vertex.
    EXPECT_FLOAT_EQ(t.survival_factors[0], float(std::sqrt((0.5 * 4 + 0.5 * 3) / 0.5)));
    EXPECT_FLOAT_EQ(t.survival_factors[1], float(std::sqrt(0.5 * 3 / 0.5)));
}

/// Records without information give finite factors.
TEST(SurvivalFactors, AreFinite)
{
    const GuidingRecords bright = part_of({{continued_surface(0.5f, 0, 1)}}),
                         dark = part_of({{continued_surface(0.5f, 0, 0)}}),
                         black = part_of({{continued_surface(0.5f, 0, 1, 0)}});
    const auto need = [](const GuidingRecords& part, double square, double variance) {
        GuidingTables t = row_of_regions(1);
        set_survival_factors(path_statistics(part, &square, 1, 0.5, variance), t);
        return t.survival_factors[0];
    };
    // The record has half a vertex after it, and a whole path costs one.
    EXPECT_FLOAT_EQ(need(bright, 1, 1), std::sqrt(2.f));
    EXPECT_EQ(need(dark, 1, 1), 0);
    EXPECT_EQ(need(black, 1, 1), 0);
    EXPECT_EQ(need(bright, 0, 1), 0);
    EXPECT_EQ(need(bright, 1, 0), 0);
    EXPECT_FLOAT_EQ(need(bright, 1e-300, 1e-300), 1e30f);
}

}  // namespace
}  // namespace fathom
