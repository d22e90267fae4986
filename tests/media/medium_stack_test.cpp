// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "media/distance.h"
#include "media/stack.h"
#include "support/lane_helpers.h"

namespace fathom {
namespace {

using test::first;

/// Seven media, some with equal priority.
MediaTables tables()
{
    MediaTables t;
    for (std::uint32_t priority : {5u, 3u, 5u, 8u, 3u, 1u, 2000u}) {
        MediumRecord medium;
        medium.priority = priority;
        medium.ior = 1 + 0.1f * float(t.media.size());
        t.media.push_back(medium);
    }
    return t;
}

/// The medium stack as a plain list.
struct Reference {
    const MediaTables& t;
    std::vector<std::uint32_t> in;

    void enter(std::uint32_t medium)
    {
        const auto gives_way = [&](std::uint32_t other) { return t.media[other].priority <= t.media[medium].priority; };
        in.insert(std::find_if(in.begin(), in.end(), gives_way), medium);
    }
    void leave(std::uint32_t medium)
    {
        const auto found = std::find(in.begin(), in.end(), medium);
        if (found != in.end()) in.erase(found);
    }
    std::uint32_t current() const { return in.empty() ? 0 : in.front(); }
};

TEST(MediumStack, HasTheGreatestPriorityInFrontAndOfEqualOnesTheLast)
{
    const MediaTables t = tables();
    std::mt19937 random(5);
    for (int round = 0; round < 300; ++round) {
        MediumStack stack;
        Reference reference{t, {}};
        for (int step = 0; step < 30; ++step) {
            const std::uint32_t medium = 1 + random() % 7;
            const bool enters = random() % 2 && reference.in.size() < 4;
            const MediumBoundary boundary(t, stack, UInt(medium), Mask(enters), Mask(true));
            const bool known = std::find(reference.in.begin(), reference.in.end(), medium) != reference.in.end();
            Reference inside{t, reference.in}, outside{t, reference.in};
            if (enters)
                inside.enter(medium), reference.enter(medium);
            else
                outside.leave(medium), reference.leave(medium);
            // leaving an unknown medium acts as if the path had entered it
            if (!enters && !known) inside.enter(medium);
            EXPECT_EQ(first(boundary.is_there), inside.current() == medium && outside.current() != medium);
            EXPECT_EQ(first(boundary.other_ior), t.media[outside.current()].ior);
            stack = boundary.beyond;
            ASSERT_EQ(first(stack.current()), reference.current());
        }
    }
}

TEST(MediumStack, TransmittanceOfAnyLength)
{
    MediaTables t = tables();
    t.media[1].extinction = {0.5f, 0, 2};
    const auto at = [&](std::uint32_t medium, float length, int c) {
        return first(
            transmittance(gather(t.media, &MediumRecord::extinction, UInt(medium), Mask(true)), Float(length)).c[c]);
    };
    const float infinite = std::numeric_limits<float>::infinity();
    EXPECT_NEAR(at(1, 3, 0), std::exp(-1.5), 1e-6);
    EXPECT_EQ(at(1, 3, 1), 1);
    EXPECT_EQ(at(1, infinite, 1), 1);
    EXPECT_EQ(at(1, infinite, 2), 0);
    EXPECT_EQ(at(0, infinite, 0), 1);
}

}  // namespace
}  // namespace fathom
