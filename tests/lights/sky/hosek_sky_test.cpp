// SPDX-License-Identifier: Apache-2.0
#include "lights/sky/hosek_sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace fathom {
namespace {

/// Values equal those of Mitsuba 3.9.1's `sunsky`, also between the table's turbidities, albedos and solar elevations.
TEST(HosekSky, IsMitsubas)
{
    const struct {
        double turbidity, albedo, elevation_deg;
        Vec3d direction;
        Color radiance;
    } seen[] = {
        {1, 0, 10, {-0.2143, 0.7987, -0.5624}, {0.01102f, 0.02085f, 0.03619f}},
        {1, 0, 10, {0.1893, 0.5293, 0.8271}, {0.02054f, 0.03462f, 0.05386f}},
        {2, 0.3, 30, {0.7396, 0.1002, 0.6656}, {0.13822f, 0.19916f, 0.24195f}},
        {2, 0.3, 30, {-0.8666, 0.4299, 0.2534}, {0.04094f, 0.07466f, 0.12699f}},
        {3, 0.3, 50, {-0.9954, 0.0953, -0.0052}, {0.13103f, 0.19388f, 0.26893f}},
        {3, 0.3, 50, {-0.0733, 0.6567, 0.7506}, {0.03220f, 0.05948f, 0.11704f}},
        {3.7, 0.3, 7, {-0.8791, 0.4545, -0.1438}, {0.03352f, 0.04718f, 0.05631f}},
        {3.7, 0.3, 7, {-0.2600, 0.8848, -0.3866}, {0.01077f, 0.01874f, 0.02799f}},
        {5, 1, 60, {0.9090, 0.4149, 0.0399}, {0.18045f, 0.24375f, 0.33183f}},
        {5, 1, 60, {-0.6809, 0.6793, 0.2736}, {0.05673f, 0.09948f, 0.17556f}},
        {6.5, 0.6, 20, {0.1107, 0.5667, 0.8164}, {0.04487f, 0.06249f, 0.08692f}},
        {6.5, 0.6, 20, {-0.4566, 0.8681, 0.1949}, {0.02434f, 0.03823f, 0.06017f}},
        {8, 0, 80, {-0.5012, 0.6816, -0.5331}, {0.06203f, 0.08378f, 0.12281f}},
        {8, 0, 80, {-0.7643, 0.2614, -0.5894}, {0.07373f, 0.09904f, 0.14613f}},
        {10, 0.3, 3, {-0.5049, 0.8611, 0.0590}, {0.01472f, 0.01614f, 0.01670f}},
        {10, 0.3, 3, {-0.7062, 0.7080, 0.0053}, {0.02078f, 0.02140f, 0.02011f}},
    };
    for (const auto& s : seen) {
        const double elevation = s.elevation_deg * std::numbers::pi / 180;
        const HosekSky sky({std::cos(elevation), std::sin(elevation), 0}, s.turbidity, s.albedo);
        const Color c = sky.radiance(normalize(s.direction));
        EXPECT_NEAR(c.r / s.radiance.r, 1, 0.015) << s.turbidity << ' ' << s.elevation_deg;
        EXPECT_NEAR(c.g / s.radiance.g, 1, 0.015) << s.turbidity << ' ' << s.elevation_deg;
        EXPECT_NEAR(c.b / s.radiance.b, 1, 0.015) << s.turbidity << ' ' << s.elevation_deg;
        EXPECT_EQ(sky.radiance({0.6, -0.8, 0}), (Color{0, 0, 0}));
    }
}

}  // namespace
}  // namespace fathom
