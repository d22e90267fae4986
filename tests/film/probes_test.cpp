// SPDX-License-Identifier: Apache-2.0
#include "film/probes.h"

#include <gtest/gtest.h>

#include <set>

namespace fathom {
namespace {

/// One pixel in 32, spread evenly over rows, columns of a cell and both sets, wherever the rectangle lies.
TEST(Probes, AreSpreadEvenly)
{
    for (const Crop crop : {Crop{0, 0, 320, 200}, Crop{37, 11, 37 + 320, 11 + 200}}) {
        const std::vector<Probe> probes = probes_of(400, crop);
        ASSERT_EQ(probes.size(), 320u * 200 / 32);
        std::vector<int> in_column(32), in_row(200);
        int deciding = 0;
        for (const Probe& p : probes) {
            ASSERT_TRUE(p.x >= crop.x0 && p.x < crop.x1 && p.y >= crop.y0 && p.y < crop.y1);
            ++in_column[std::size_t(p.x - crop.x0) % 32];
            ++in_row[std::size_t(p.y - crop.y0)];
            deciding += p.decides;
        }
        for (const int count : in_column) EXPECT_NEAR(count, 2000 / 32, 12);
        for (const int count : in_row) EXPECT_EQ(count, 10);
        EXPECT_EQ(deciding, 1000);
    }
}

/// Each probe has three pixels of its row and of the rectangle for its sums, which no other probe uses.
TEST(Probes, HavePlacesForTheirSums)
{
    for (const int width : {1, 2, 3, 31, 32, 33, 34, 35, 64, 100}) {
        const Crop crop{5, 2, 5 + width, 40};
        std::set<std::size_t> used;
        int count = 0;
        for (const Probe& p : probes_of(120, crop)) {
            ++count;
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_TRUE(used.insert(p.sums + c).second);
                EXPECT_EQ(int((p.sums + c) / 120), p.y);
                const int x = int((p.sums + c) % 120);
                EXPECT_TRUE(x >= crop.x0 && x < crop.x1) << x;
            }
        }
        EXPECT_EQ(count == 0, width < 3) << width;
    }
}

/// Also pixels of an incomplete cell at the right border are probes as often as others.
TEST(Probes, TreatTheRightBorderLikeTheRest)
{
    int at_border = 0;
    for (const Probe& p : probes_of(48, Crop{0, 0, 48, 3200})) at_border += p.x >= 32;
    EXPECT_NEAR(at_border, 3200 / 2, 60);
}

TEST(Probes, HaveAnotherSeed)
{
    EXPECT_NE(probe_seed(0), 0u);
    EXPECT_NE(probe_seed(0), probe_seed(1));
}

}  // namespace
}  // namespace fathom
