// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "session/guiding_tables.h"

namespace fathom {
namespace {

constexpr std::uint16_t usual_bin = 4 * guiding_sectors + 6, other_bin = 6 * guiding_sectors + 12;

/// Records of surfaces along x, all of side 0, with incident light of equal radiance.
GuidingRecords row_of_surfaces(int count)
{
    GuidingRecords part;
    for (int i = 0; i < count; ++i) {
        GuidingRecord r{{(float(i) + 0.5f) / float(count), 0.5f, 0.5f}};
        r.bin = usual_bin, r.value = 1;
        part.surfaces.push_back(r);
        part.counts.push_back(1);
    }
    return part;
}

/// Probability of a bin in the region of side 0 of a cell.
float bin_probability(const GuidingTables& t, std::uint32_t cube, std::uint32_t bin)
{
    const std::uint32_t region = t.regions[std::size_t(cube) * guiding_sides];
    if (region == no_index) return -1;
    const float* const sums = &t.histograms[std::size_t(region) * guiding_stride];
    return sums[bin + 1] - sums[bin];
}

/// A cell's region gets half of its data from its block of eight cells and none from the next block.
TEST(GuidingTables, RegionsShareWithTheirBlock)
{
    GuidingRecords part = row_of_surfaces(40000);
    const std::shared_ptr<GuidingTables> cubes = make_guiding({&part});
    ASSERT_TRUE(cubes);
    ASSERT_GE(cubes->cells[0], 4u);
    // In the second cell light comes from another direction.
    for (GuidingRecord& r : part.surfaces)
        if (guiding_cube(*cubes, r.position) == 1) r.bin = other_bin;
    const std::shared_ptr<GuidingTables> t = make_guiding({&part});
    ASSERT_EQ(t->cells[0], cubes->cells[0]);
    // A bin gives a tenth of its value to each of its four neighbors; a twentieth of the whole is uniform.
    constexpr float kept = 0.95f / 1.4f, even = 0.05f / (guiding_bins / 2);
    EXPECT_NEAR(bin_probability(*t, 0, usual_bin), 0.75f * kept + even, 0.01f);
    EXPECT_NEAR(bin_probability(*t, 0, other_bin), 0.25f * kept + even, 0.01f);
    EXPECT_NEAR(bin_probability(*t, 1, other_bin), 0.75f * kept + even, 0.01f);
    EXPECT_NEAR(bin_probability(*t, 1, usual_bin), 0.25f * kept + even, 0.01f);
    EXPECT_NEAR(bin_probability(*t, 2, usual_bin), kept + even, 1e-4f);
    EXPECT_NEAR(bin_probability(*t, 2, other_bin), even, 1e-4f);
    // Values are limited to 200 times their mean.
    EXPECT_DOUBLE_EQ(t->max_value, 200);
}

/// Histograms can be learned again from other records, in the regions of all.
TEST(GuidingTables, LearnHistogramsAgain)
{
    const GuidingRecords part = row_of_surfaces(40000);
    GuidingRecords other = row_of_surfaces(40000);
    for (GuidingRecord& r : other.surfaces) r.bin = other_bin;
    const std::shared_ptr<GuidingTables> t = make_guiding({&part, &other});
    learn_histograms({&other}, *t);
    EXPECT_LT(bin_probability(*t, 0, usual_bin), 0.01f);
    EXPECT_GT(bin_probability(*t, 0, other_bin), 0.6f);
    learn_histograms({&part, &other}, *t);
    EXPECT_FLOAT_EQ(bin_probability(*t, 0, usual_bin), bin_probability(*t, 0, other_bin));
}

/// Without enough records there are no tables.
TEST(GuidingTables, NeedRecords)
{
    const GuidingRecords none = row_of_surfaces(0), few = row_of_surfaces(30);
    EXPECT_FALSE(make_guiding({}));
    EXPECT_FALSE(make_guiding({&none}));
    EXPECT_FALSE(make_guiding({&few, &none}));
}

}  // namespace
}  // namespace fathom
