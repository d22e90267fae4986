// SPDX-License-Identifier: Apache-2.0
#include "textures/ramp.h"

#include "texture_checks.h"

namespace fathom::test {
namespace {

TEST(RampTexture, IsLinearBetweenStopsAndConstantBeyond)
{
    TextureFixture f;
    // Another ramp's stops come first in the table.
    f.tables.ramp_stops = {{0, {9, 9, 9}}, {1, {9, 9, 9}}};
    TextureRecord ramp = TextureFixture::of(TextureKind::ramp);
    ramp.first_stop = 2, ramp.stop_count = 3;
    f.tables.ramp_stops.insert(f.tables.ramp_stops.end(), {{0.2f, {1, 0, 0}}, {0.4f, {0, 1, 0}}, {0.8f, {0, 0, 2}}});
    const auto color = [&](float x) {
        ramp.factor = x;
        return f.at(f.add(ramp));
    };
    const auto expect = [](Rgba c, float r, float g, float b) {
        EXPECT_NEAR(c[0], r, 1e-6);
        EXPECT_NEAR(c[1], g, 1e-6);
        EXPECT_NEAR(c[2], b, 1e-6);
        EXPECT_EQ(c[3], 1);
    };
    expect(color(0), 1, 0, 0);
    expect(color(0.2f), 1, 0, 0);
    expect(color(0.25f), 0.75f, 0.25f, 0);
    expect(color(0.4f), 0, 1, 0);
    expect(color(0.5f), 0, 0.75f, 0.5f);
    expect(color(0.8f), 0, 0, 2);
    expect(color(1), 0, 0, 2);
}

}  // namespace
}  // namespace fathom::test
