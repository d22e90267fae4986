// SPDX-License-Identifier: Apache-2.0
#include "session/guiding_shares.h"

#include <gtest/gtest.h>

#include <numbers>

namespace fathom {
namespace {

/// A cube with a region of side 0, whose histogram has half of its mass in bin 0 and half in bin 1.
GuidingTables one_region()
{
    GuidingTables t;
    t.cells[0] = t.cells[1] = t.cells[2] = 1;
    t.inverse_cell = 1;
    t.regions.assign(guiding_sides, no_index);
    t.regions[0] = 0;
    t.histograms.assign(guiding_stride, 1);
    t.histograms[0] = 0, t.histograms[1] = 0.5f;
    return t;
}

/// Record of a direction that the histogram samples `ratio` times as densely as the closure.
GuidingRecord direction(double ratio, float contribution, std::uint8_t guidable = GuidingRecord::fully_guidable)
{
    GuidingRecord r{{0.5f, 0.5f, 0.5f}, 0, guidable};
    const double density = 0.5 * guiding_bins / (4 * std::numbers::pi);
    r.bin = ratio > 0 ? 0 : 2;
    r.bsdf_pdf = float(ratio > 0 ? density / ratio : density);
    r.contribution = contribution;
    return r;
}

/// Share of the region for paths of one record each, with pixels of these squared brightnesses.
float share_for(const std::vector<GuidingRecord>& records, std::vector<double> squares = {})
{
    GuidingRecords part;
    part.surfaces = records;
    part.counts.assign(records.size(), 1);
    squares.resize(records.size(), 1);
    PathStatistics met;
    met.parts = {{&part, squares.data()}};
    met.samples = 1;
    GuidingTables t = one_region();
    set_shares(met, t);
    return t.shares.at(0);
}

TEST(GuidingShares, GuideWhereTheHistogramIsBetter)
{
    EXPECT_FLOAT_EQ(share_for({direction(3, 1)}), 0.65f);
    EXPECT_FLOAT_EQ(share_for({direction(0.4, 1)}), 0);
}

/// Squared contributions of 1 and 0.55 have the second moment 1 / (1 + 3 a) + 0.55 / (1 - a) for the share a. It
/// is 1.55 without guidance, 1.304 for 0.25, and 1.426 for 0.45.
TEST(GuidingShares, CompareSecondMoments)
{
    EXPECT_FLOAT_EQ(share_for({direction(4, 1), direction(0, 0.7416f)}), 0.25f);
    // With a pixel of a quarter of the squared brightness the second moment of the other direction prevails.
    EXPECT_FLOAT_EQ(share_for({direction(4, 1), direction(0, 0.7416f)}, {1, 0.25}), 0);
    EXPECT_FLOAT_EQ(share_for({direction(4, 1), direction(0, 0.7416f)}, {0.05, 1}), 0.65f);
}

/// Closures that can only be guided half get half of the share, so that 0.45 acts as 0.225.
TEST(GuidingShares, CountWhatClosuresAllow)
{
    EXPECT_FLOAT_EQ(share_for({direction(4, 1, 128), direction(0, 0.7416f, 128)}), 0.45f);
    EXPECT_FLOAT_EQ(share_for({direction(4, 1, 0), direction(0, 0.5f, 0)}), 0);
}

/// Without light, without a direction, and in pixels without brightness nothing is guided.
TEST(GuidingShares, AreZeroWithoutData)
{
    GuidingRecord ended = direction(4, 1), unknown = direction(4, 1);
    ended.bin = GuidingRecord::no_bin;
    unknown.side = 3;
    EXPECT_EQ(share_for({}), 0);
    EXPECT_EQ(share_for({ended, unknown}), 0);
    EXPECT_EQ(share_for({direction(4, 0)}), 0);
    EXPECT_EQ(share_for({direction(4, 1)}, {0}), 0);
}

}  // namespace
}  // namespace fathom
