// SPDX-License-Identifier: Apache-2.0
#include "lights/sky/sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "compile/scene_data.h"
#include "fathom/render.h"

namespace fathom {
namespace {

double luminance(const Color& c)
{
    return 0.2126 * double(c.r) + 0.7152 * double(c.g) + 0.0722 * double(c.b);
}

/// Direction to the sun above +x at an elevation in degrees.
Vec3d sun_at(double elevation_deg)
{
    const double e = elevation_deg * std::numbers::pi / 180;
    return {std::cos(e), std::sin(e), 0};
}

/// Optical depths straight up have closed forms for exponential densities and the triangular ozone profile.
TEST(Sky, DepthsStraightUp)
{
    for (double height : {0.0, 2.0, 12.0}) {
        const Sky::OpticalDepths depths = Sky::depths_to_space(height, 1);
        const auto exponential = [&](double scale) {
            return scale * (std::exp(-height / scale) - std::exp(-60 / scale));
        };
        EXPECT_NEAR(depths.molecules, exponential(8), 1e-3 * exponential(8));
        EXPECT_NEAR(depths.haze, exponential(1.2), 2e-3 * exponential(1.2));
        const double below = height > 10 ? (height - 10) * (height - 10) / 30 : 0;
        EXPECT_NEAR(depths.ozone, 15 - below, 0.01);
    }
    // Rayleigh optical depth of the atmosphere at 550 nm is 0.097 (Bucholtz 1995); Bruneton's coefficients are a tenth
    // higher.
    EXPECT_NEAR(-std::log(Sky::transmittance({8, 0, 0}, 550)), 0.103, 0.008);
    EXPECT_NEAR(-std::log(Sky::transmittance({0, 1.2, 0}, 550)), 0.1, 1e-12);
    // Rayleigh scattering is proportional to wavelength^-4.
    EXPECT_NEAR(std::log(Sky::transmittance({1, 0, 0}, 400)) / std::log(Sky::transmittance({1, 0, 0}, 600)),
                std::pow(1.5, 4), 1e-9);
    // 300 Dobson units of ozone absorb about 3.5 % near 600 nm (Chappuis band).
    EXPECT_NEAR(1 - Sky::transmittance({0, 0, 15}, 600), 0.04, 0.006);
}

/// Air mass agrees with the independent fit of Kasten and Young (1989), at elevations down to the horizon.
TEST(Sky, AirMassTowardsTheHorizon)
{
    const double up = Sky::depths_to_space(0, 1).molecules;
    for (double elevation : {60.0, 30.0, 10.0, 5.0, 2.0}) {
        const double mass =
            1 / (std::sin(elevation * std::numbers::pi / 180) + 0.50572 * std::pow(elevation + 6.07995, -1.6364));
        const double found = Sky::depths_to_space(0, std::sin(elevation * std::numbers::pi / 180)).molecules / up;
        // Straight rays are assumed; atmospheric refraction is 5 % at 2 degrees.
        EXPECT_NEAR(found / mass, 1, elevation > 9 ? 0.01 : 0.06) << elevation;
    }
}

/// The sun gives 133 klx above the atmosphere; 100 to 120 klx reach the ground from high in a clear sky, which adds a
/// tenth to a quarter of that.
TEST(Sky, SunAndSkyInProportion)
{
    const double klx = 133.3 / std::numbers::pi;
    const double sun = luminance(Sky::sun_irradiance(sun_at(60))) * klx;
    EXPECT_GT(sun, 95);
    EXPECT_LT(sun, 120);
    const Sky sky(sun_at(60));
    double from_sky = 0;
    constexpr int rows = 40, columns = 80;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            const double sine = std::sqrt((i + 0.5) / rows), phi = 2 * std::numbers::pi * (j + 0.5) / columns;
            from_sky +=
                luminance(sky.radiance({sine * std::cos(phi), std::sqrt(1 - sine * sine), sine * std::sin(phi)})) *
                std::numbers::pi / (rows * columns);
        }
    const double horizontal = sun * std::sin(std::numbers::pi / 3);
    EXPECT_GT(from_sky * klx / horizontal, 0.08);
    EXPECT_LT(from_sky * klx / horizontal, 0.25);
    // The ground reflects a fifth of the total illuminance over the hemisphere.
    const double ground = luminance(sky.radiance({0.8, -0.6, 0}));
    EXPECT_NEAR(ground / (0.2 / std::numbers::pi * (horizontal / klx + from_sky)), 1, 0.02);
}

/// Illuminance of a horizontal surface by the sky, in klx.
double diffuse_klx(const Sky& sky)
{
    constexpr double klx = 133.3 / std::numbers::pi;
    constexpr int rows = 30, columns = 60;
    double sum = 0;
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            const double sine = std::sqrt((i + 0.5) / rows), phi = 2 * std::numbers::pi * (j + 0.5) / columns;
            sum += luminance(sky.radiance({sine * std::cos(phi), std::sqrt(1 - sine * sine), sine * std::sin(phi)}));
        }
    return sum * klx * std::numbers::pi / (rows * columns);
}

/// Illuminance agrees with fits to measured clear skies: Illuminating Engineering Society of North America, RP-21,
/// 1984.
TEST(Sky, IlluminanceAsMeasured)
{
    constexpr double klx = 133.3 / std::numbers::pi;
    for (double elevation : {20., 30., 45., 60., 80.}) {
        const double sine = std::sin(elevation * std::numbers::pi / 180);
        const double sun = 127.5 * std::exp(-0.21 / sine), sky = 0.8 + 15.5 * std::sqrt(sine);
        EXPECT_NEAR(luminance(Sky::sun_irradiance(sun_at(elevation))) * klx / sun, 1, 0.03) << elevation;
        // Without multiple scattering it is 12 to 18 % lower.
        const double ratio = diffuse_klx(Sky(sun_at(elevation))) / sky;
        EXPECT_GT(ratio, 1) << elevation;
        EXPECT_LT(ratio, 1.2) << elevation;
    }
}

/// Luminance relative to the zenith, in the plane perpendicular to the sun's and opposite to the sun, agrees with ISO
/// 15469 type 12, a clear sky with low turbidity. Single scattering gives half of that at the horizon, and twice that
/// opposite a low sun.
TEST(Sky, BrightnessAsTheStandardClearSky)
{
    for (double elevation : {20., 30., 45.}) {
        const double sun_zenith = (90 - elevation) * std::numbers::pi / 180;
        const Sky sky(sun_at(elevation));
        const auto standard = [&](const Vec3d& d) {
            const double chi = std::acos(std::clamp(dot(d, sun_at(elevation)), -1.0, 1.0));
            const auto indicatrix = [](double angle) {
                const double c = std::cos(angle);
                return 1 + 10 * (std::exp(-3 * angle) - std::exp(-3 * std::numbers::pi / 2)) + 0.45 * c * c;
            };
            const auto gradation = [](double y) { return 1 - std::exp(-0.32 / y); };
            return indicatrix(chi) * gradation(d.y) / (indicatrix(sun_zenith) * gradation(1));
        };
        for (double height_deg : {5., 15., 30., 60.})
            for (double away : {0., 1.}) {
                const double h = height_deg * std::numbers::pi / 180;
                const Vec3d d{-away * std::cos(h), std::sin(h), (1 - away) * std::cos(h)};
                const double ratio = luminance(sky.radiance(d)) / luminance(sky.radiance({0, 1, 0}));
                EXPECT_NEAR(ratio / standard(d), 1, 0.55) << elevation << " " << height_deg << " " << away;
                EXPECT_GT(luminance(sky.radiance(d)), 1.1 * luminance(sky.scattered_once(d)));
            }
        // The horizon is whiter and brighter than the zenith.
        const Color zenith = sky.radiance({0, 1, 0}), low = sky.radiance({0, 0.05, std::sqrt(1 - 0.0025)});
        EXPECT_GT(luminance(low), 2 * luminance(zenith));
        EXPECT_LT(low.b / low.r, 0.75f * zenith.b / zenith.r);
    }
}

TEST(Sky, IsBlueAboveAndBrighterAtTheHorizon)
{
    const Sky sky(sun_at(45));
    const Color zenith = sky.radiance({0, 1, 0});
    EXPECT_GT(zenith.b, 1.4f * zenith.g);
    EXPECT_GT(zenith.g, 1.2f * zenith.r);
    // The directions are opposite to the sun and beside it.
    for (const Vec3d& d : {Vec3d{-0.996, 0.087, 0}, {0, 0.087, 0.996}})
        EXPECT_GT(luminance(sky.radiance(d)), 1.3 * luminance(zenith));
    // The sky is symmetric about the sun's plane, and bright around the sun.
    const Color left = sky.radiance({0.6, 0.48, 0.64}), right = sky.radiance({0.6, 0.48, -0.64});
    EXPECT_NEAR(left.g, right.g, 1e-6f * left.g);
    EXPECT_GT(luminance(sky.radiance(sun_at(48))), 5 * luminance(zenith));
}

TEST(Sky, TheSunReddensAndSets)
{
    double redness = 0, brightness = 1e9;
    for (double elevation : {90., 45., 20., 10., 5., 2., 0.5}) {
        const Color c = Sky::sun_irradiance(sun_at(elevation));
        const double ratio = double(c.r) / double(c.g);
        EXPECT_GT(ratio, redness) << elevation;
        EXPECT_LT(luminance(c), brightness) << elevation;
        redness = ratio, brightness = luminance(c);
    }
    EXPECT_GT(redness, 3);
    EXPECT_EQ(luminance(Sky::sun_irradiance(sun_at(-1))), 0);
    // In twilight a small part of the daylight remains.
    const double day = luminance(Sky(sun_at(30)).radiance({0, 1, 0}));
    const double dusk = luminance(Sky(sun_at(-3)).radiance({0, 1, 0}));
    EXPECT_GT(dusk, 1e-5 * day);
    EXPECT_LT(dusk, 0.1 * day);
    for (double elevation : {-90., 0., 90.}) {
        const Sky sky(sun_at(elevation));
        for (double y : {-1., 0., 1e-9, 0.5, 1.}) {
            const Color c = sky.radiance({std::sqrt(1 - y * y), y, 0});
            EXPECT_TRUE(std::isfinite(c.r + c.g + c.b) && c.r >= 0 && c.g >= 0 && c.b >= 0);
        }
    }
}

/// Luminance equals that of plain numerical integration in small equal steps, with the transmittance to the sun
/// integrated at each step.
TEST(Sky, ScatteringAgainstAPlainSum)
{
    const Vec3d to_sun = sun_at(35);
    const Sky sky(to_sun);
    const auto plain = [&](const Vec3d& d, double wavelength) {
        constexpr double earth = 6360, top = 6420;
        const double way = -earth * d.y + std::sqrt(earth * earth * (d.y * d.y - 1) + top * top);
        constexpr int steps = 1500;
        const double cosine = dot(d, to_sun), g = 0.8;
        const double molecules = 3 / (16 * std::numbers::pi) * (1 + cosine * cosine);
        const double haze = 3 / (8 * std::numbers::pi) * (1 - g * g) * (1 + cosine * cosine) /
                            ((2 + g * g) * std::pow(1 + g * g - 2 * g * cosine, 1.5));
        const double at_ground[] = {-std::log(Sky::transmittance({1, 0, 0}, wavelength)),
                                    -std::log(Sky::transmittance({0, 1, 0}, wavelength))};
        Sky::OpticalDepths seen;
        double sum = 0;
        for (int i = 0; i < steps; ++i) {
            const double length = way / steps;
            const Vec3d p = Vec3d{0, earth, 0} + d * ((i + 0.5) * length);
            const double r = std::sqrt(dot(p, p)), height = r - earth;
            seen.molecules += std::exp(-height / 8) * length;
            seen.haze += std::exp(-height / 1.2) * length;
            seen.ozone += std::max(0.0, 1 - std::abs(height - 25) / 15) * length;
            const Sky::OpticalDepths sun = Sky::depths_to_space(height, dot(p, to_sun) / r);
            const double left = Sky::transmittance(
                {seen.molecules + sun.molecules, seen.haze + sun.haze, seen.ozone + sun.ozone}, wavelength);
            sum += left * length *
                   (at_ground[0] * std::exp(-height / 8) * molecules +
                    0.9 * at_ground[1] * std::exp(-height / 1.2) * haze);
        }
        return sum;
    };
    // Luminance from the spectrum weighted by the luminous efficiency function in wide steps, mostly near 555 nm.
    const auto plain_luminance = [&](const Vec3d& d) {
        double sum = 0, weight = 0;
        for (int i = 0; i < 11; ++i) {
            const double wavelength = 465 + 20 * i;
            const double t = (wavelength - 559) / 42, y = std::exp(-0.5 * t * t);
            sum += y * plain(d, wavelength), weight += y;
        }
        return std::numbers::pi * sum / weight;
    };
    for (const Vec3d& d : {Vec3d{0, 1, 0}, {-0.8, 0.6, 0}, {0, 0.2, std::sqrt(0.96)}, {0.995, 0.0998, 0}})
        EXPECT_NEAR(luminance(sky.scattered_once(d)) / plain_luminance(d), 1, 0.03) << d.y;
}

/// The lower half of the sky image shows lit ground, or black without one; the upper half is equal.
TEST(Sky, WithoutGround)
{
    SceneDescription d;
    d.cameras.resize(1);
    d.nodes.resize(1);
    d.nodes[0].camera = 0;
    d.roots = {0};
    d.environment.kind = EnvironmentKind::sky;
    Warnings warnings;
    const auto picture = [&](bool has_ground) {
        d.environment.sky_ground = has_ground;
        const Scene scene = Scene::compile(d, "", warnings);
        const EnvironmentRecord& e = scene.data().tables->environment;
        return std::vector<float>(e.texels.begin(), e.texels.end());
    };
    const std::vector<float> with = picture(true), without = picture(false);
    ASSERT_EQ(with.size(), without.size());
    ASSERT_GT(with.size(), 1000u);
    for (std::size_t i = 0; i < with.size(); ++i) {
        if (i % 4 == 3) continue;
        ASSERT_GT(with[i], 0) << i;
        ASSERT_EQ(without[i], i < with.size() / 2 ? with[i] : 0) << i;
    }
}

}  // namespace
}  // namespace fathom
