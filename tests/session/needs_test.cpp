#include "session/needs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fathom {
namespace {

/// Cubes of edge 1 along x.
GuidingTables row_of_cubes(std::uint32_t count)
{
    GuidingTables t;
    t.cells[0] = count, t.cells[1] = t.cells[2] = 1;
    t.inverse_cell = 1;
    return t;
}

GuidingRecord surface(float x, float light)
{
    GuidingRecord r{{x, 0.5f, 0.5f}, 0, GuidingRecord::no_bin, 0, 0};
    r.light = light;
    return r;
}

/// Paths each with its surfaces.
GuidingRecords part_of(const std::vector<std::vector<GuidingRecord>>& paths)
{
    GuidingRecords part;
    for (const std::vector<GuidingRecord>& path : paths) {
        part.surfaces.insert(part.surfaces.end(), path.begin(), path.end());
        part.counts.push_back(std::uint8_t(path.size()));
    }
    return part;
}

/// Two paths for each of two pixels, the second of which is a quarter as bright.
TEST(LightNeeds, GoByWhatSamplesBringBesideTheirPixels)
{
    const GuidingRecords first = part_of({{surface(0.5f, 2), surface(1.5f, 0)}, {surface(0.2f, 4)}, {}}),
                         second = part_of({{surface(1.9f, 1)}});
    PathsMet met;
    met.parts = {&first, &second};
    met.brightness_squares = {4, 0.25};
    met.samples = 2;
    met.vertices = 3, met.variance = 2;
    GuidingTables t = row_of_cubes(3);
    set_light_needs(met, t);
    // Squares beside the brightness: 4 / 4 + 16 / 4 = 5 in the first cube, 1 / 0.25 = 4 in the second, two samples
    // each; 9 / 4 in the mean, which counts as 32 samples. A light sample takes a quarter of a vertex: 3 / (2 * 0.25)
    // = 6.
    ASSERT_EQ(t.light_needs.size(), 3u);
    EXPECT_FLOAT_EQ(t.light_needs[0], float(1.5 * std::sqrt((5 + 72) / 34.0 * 6)));
    EXPECT_FLOAT_EQ(t.light_needs[1], float(1.5 * std::sqrt((4 + 72) / 34.0 * 6)));
    EXPECT_FLOAT_EQ(t.light_needs[2], float(1.5 * std::sqrt(2.25 * 6)));
}

/// With many samples the cube alone decides: the root of what a sample brings, squared, over the paths' noise.
TEST(LightNeeds, AreThoseOfTheirCube)
{
    const std::size_t paths = 200'000;
    std::vector<std::vector<GuidingRecord>> bright(paths, {surface(0.5f, 0.4f)}), dark(paths, {surface(1.5f, 0.01f)});
    const GuidingRecords first = part_of(bright), second = part_of(dark);
    PathsMet met;
    met.parts = {&first, &second};
    met.brightness_squares.assign(paths / 2, 1);
    met.samples = 4;
    met.vertices = 4, met.variance = 16;
    GuidingTables t = row_of_cubes(2);
    set_light_needs(met, t);
    EXPECT_NEAR(t.light_needs[0], 1.5 * 0.4, 1e-3);
    EXPECT_NEAR(t.light_needs[1], 1.5 * 0.01, 2e-3);
}

/// Many parts are shared among threads; each path stays beside its own pixel.
TEST(LightNeeds, KeepPathsBesideTheirPixels)
{
    std::vector<GuidingRecords> parts(37);
    PathsMet met;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        // As bright as what its samples bring: all are alike.
        const float light = float(1 + i);
        parts[i] = part_of({{surface(0.5f, light)}, {}, {surface(0.5f, light), surface(0.5f, light)}});
        met.parts.push_back(&parts[i]);
        met.brightness_squares.push_back(double(light) * double(light));
    }
    met.samples = 3;
    met.vertices = 1, met.variance = 4;
    GuidingTables t = row_of_cubes(1);
    set_light_needs(met, t);
    EXPECT_FLOAT_EQ(t.light_needs[0], 1.5f);
}

/// What tells nothing gives no number that is none.
TEST(LightNeeds, AreFinite)
{
    const GuidingRecords some = part_of({{surface(0.5f, 1)}}), none = part_of({{}});
    const auto need = [](const GuidingRecords& part, double square, double variance) {
        PathsMet met;
        met.parts = {&part};
        met.brightness_squares = {square};
        met.samples = 1;
        met.vertices = 1, met.variance = variance;
        GuidingTables t = row_of_cubes(1);
        set_light_needs(met, t);
        return t.light_needs[0];
    };
    EXPECT_FLOAT_EQ(need(some, 1, 4), 1.5f);
    EXPECT_EQ(need(none, 1, 4), 0);
    EXPECT_EQ(need(some, 0, 4), 0);
    EXPECT_EQ(need(some, 1, 0), 0);
    EXPECT_FLOAT_EQ(need(some, 1e-300, 1e-6), 1e30f);
}

}  // namespace
}  // namespace fathom
