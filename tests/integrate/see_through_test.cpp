// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

// Tests of shadow rays that pass index-matched boundaries with fog behind them, and thin panes, against closed forms
// and against BSDF sampling alone.
namespace fathom {
namespace {

using namespace test;

/// Sets absorption and scattering coefficients per meter.
void fill(Material& m, double absorption, double scattering, double mean_cosine)
{
    const auto same = [](double v) { return Color{float(v), float(v), float(v)}; };
    m.interior.attenuation_distance = 1;
    m.interior.attenuation_color = same(std::exp(-absorption - scattering));
    m.interior.scatter = same(scattering);
    m.interior.scatter_anisotropy = float(mean_cosine);
}

Material fog(double absorption, double scattering, double mean_cosine)
{
    Material m;
    m.kind = MaterialKind::glass;
    m.ior = 1;
    fill(m, absorption, scattering, mean_cosine);
    return m;
}

Material pane(float ior, float color = 1)
{
    Material m;
    m.kind = MaterialKind::glass;
    m.ior = ior;
    m.interior.thin = true;
    m.transmission.color.value = m.base_color.value = {color, color, color};
    return m;
}

double phase(double g, double cosine)
{
    return (1 - g * g) / (4 * std::numbers::pi * std::pow(1 + g * g - 2 * g * cosine, 1.5));
}

/// A sheet with two boundaries reflects 2 r / (1 + r), with r by Fresnel's equations.
double sheet_transmittance(double ior, double cosine)
{
    const double t = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    const double s = (cosine - ior * t) / (cosine + ior * t), p = (ior * cosine - t) / (ior * cosine + t);
    const double r = (s * s + p * p) / 2;
    return 1 - 2 * r / (1 + r);
}

/// Single scattering in a slab of fog, seen along its normal and lit from a direction, has a closed form. Only that
/// scattering event is a bounce.
TEST(SeeThrough, FogScattersOnce)
{
    for (const double g : {0.0, 0.6, -0.4})
        for (const double degrees : {20.0, 55.0}) {
            SceneBuilder b;
            const double absorbed = 0.2, scattered = 0.5, depth = 1.5, extinction = absorbed + scattered;
            b.add(Box{{-500, -500, -depth}, {500, 500, 0}}, b.material(fog(absorbed, scattered, g)));
            Light sun;
            sun.kind = LightKind::directional;
            sun.intensity = {3, 3, 3};
            const double a = degrees * std::numbers::pi / 180, cosine = std::cos(a);
            b.light(sun, rotate_to({std::sin(a), 0, -cosine}));
            b.camera({0, 0, 4}, {0, 0, 0}, 0.01);
            RenderSettings settings = small_image_settings(4, 4);
            settings.max_depth = 1;
            // Light travels z / cosine inwards and z back; the scattering angle towards the camera is the angle to +z.
            const double rate = extinction * (1 + 1 / cosine);
            const double expected = 3 * scattered * phase(g, -cosine) * (1 - std::exp(-rate * depth)) / rate;
            expect_mean(render_film(b.scene, settings, 4096), expected, 0.004);
        }
}

SceneBuilder lamp_in_fog(const Material& around)
{
    SceneBuilder b;
    b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(around));
    b.add(Rectangle{{-0.3, 0.3, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}}, b.diffuse(0, {4, 4, 4}, true));
    b.add(Rectangle{{-2, -1.5, -2}, {0, 0, 4}, {4, 0, 0}}, b.diffuse(0.6f));
    b.add(Rectangle{{-0.4, 1.8, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}}, b.diffuse(0, {6, 6, 6}, true));
    b.camera({0, 0.5, 5}, {0, -0.3, 0}, 35);
    return b;
}

/// Lights inside and outside of fog and panes, and surfaces outside: the mean is equal with and without NEE.
TEST(SeeThrough, AsByChanceAlone)
{
    Material sheet = pane(1.4f, 0.8f), full = sheet;
    fill(full, 0.3, 0.9, 0.3);
    for (const Material& m : {fog(0.3, 0.9, 0.3), sheet, full})
        for (const int max_depth : {2, 3, 12}) {
            const SceneBuilder b = lamp_in_fog(m);
            RenderSettings settings = small_image_settings(24, 24);
            settings.max_depth = max_depth;
            const Mean sampled = mean_of(render_film(b.scene, settings, 1024));
            settings.light_sampling = false;
            settings.seed = 7;
            const Mean by_chance = mean_of(render_film(b.scene, settings, 8192));
            const double error = std::hypot(sampled.error[0], by_chance.error[0]);
            EXPECT_NEAR(sampled.value[0], by_chance.value[0], 4 * error) << max_depth << " " << m.interior.thin;
            EXPECT_LT(error, 0.02 * by_chance.value[0]) << "the test is too noisy to detect a difference";
        }
}

/// Lossless fog is invisible under uniform illumination, with any boundary.
TEST(SeeThrough, WhiteFogIsNotSeen)
{
    Material full = pane(1.5f);
    fill(full, 0, 2, 0.2);
    for (const Material& m : {fog(0, 2, 0.2), full}) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(m));
        b.scene.environment.kind = EnvironmentKind::constant;
        b.scene.environment.color = {1, 1, 1};
        b.camera({0, 0, 5}, {0, 0, 0}, 30);
        expect_mean(render_film(b.scene, small_image_settings(), 256), 1, 1e-4);
    }
}

/// A point light behind two panes, each of which is a bounce.
TEST(SeeThrough, LampBehindPanes)
{
    for (const int max_depth : {1, 2, 3}) {
        SceneBuilder b;
        const float ior = 1.6f, color = 0.7f;
        const int glass = b.material(pane(ior, color));
        b.add(Rectangle{{-50, 1, -50}, {0, 0, 100}, {100, 0, 0}}, glass);
        b.add(Rectangle{{-50, 1.5, -50}, {0, 0, 100}, {100, 0, 0}}, glass);
        b.add(Rectangle{{-50, 0, -50}, {0, 0, 100}, {100, 0, 0}}, b.diffuse(0.5f));
        b.point_light({10, 10, 10}, {3, 4, 0});
        // The camera is below the panes.
        b.camera({0, 0.9, 0.1}, {0, 0, 0}, 0.01);
        RenderSettings settings = small_image_settings(4, 4);
        settings.max_depth = max_depth;
        const double passed = sheet_transmittance(double(ior), 0.8) * double(color);
        const double direct = 0.5 / std::numbers::pi * 10 * 0.8 / 25 * passed * passed;
        const Mean m = mean_of(render_film(b.scene, settings, 256));
        if (max_depth < 3)
            EXPECT_EQ(m.value[0], 0) << max_depth;
        else
            EXPECT_NEAR(m.value[0], direct, 2e-3 * direct);
    }
}

/// A light shines on a floor inside absorbing glass of index 1, whose color makes it a real boundary. A pane elsewhere
/// changes nothing.
TEST(SeeThrough, LampWithinGlassBesideAPane)
{
    for (const bool beside : {false, true}) {
        SceneBuilder b;
        Material glass;
        glass.kind = MaterialKind::glass;
        glass.ior = 1;
        glass.transmission.color.value = {0.81f, 0.81f, 0.81f};
        glass.interior.attenuation_distance = 1;
        glass.interior.attenuation_color = {0.5f, 0.5f, 0.5f};
        b.add(Box{{-30, -1, -30}, {30, 3, 30}}, b.material(glass));
        b.add(Rectangle{{-20, 0, -20}, {0, 0, 40}, {40, 0, 0}}, b.diffuse(0.5f));
        if (beside) b.add(Rectangle{{50, 0, -5}, {0, 10, 0}, {0, 0, 10}}, b.material(pane(1.5f)));
        b.point_light({10, 10, 10}, {1.5, 2, 0});
        b.camera({0, 2.5, 0}, {0, 0, 0}, 0.01);
        RenderSettings settings = small_image_settings(4, 4);
        settings.max_depth = 1;
        // Both segments are absorbed: 2.5 to the light, with a cosine of 0.8, and 2.5 to the camera.
        const double expected = 0.5 / std::numbers::pi * 10 * 0.8 / 6.25 * std::pow(0.5, 5);
        expect_mean(render_film(b.scene, settings, 64), expected);
    }
}

/// The boundary of fog is not a first hit: layers show the object behind it. Fog in front is opaque where a path
/// scatters.
TEST(SeeThrough, FirstHitsAreBehindFog)
{
    for (const double dense : {0.0, 50.0}) {
        SceneBuilder b;
        b.add(Box{{-5, -5, -1}, {5, 5, 0}}, b.material(fog(0.1, dense, 0)));
        b.add(Rectangle{{-50, -50, -3}, {100, 0, 0}, {0, 100, 0}}, b.diffuse(0.25f));
        b.camera({0, 0, 4}, {0, 0, 0}, 0.01);
        RenderSettings settings = small_image_settings(4, 4);
        settings.aovs = {Aov::depth, Aov::albedo};
        settings.alpha = true;
        const Image image = render_film(b.scene, settings, 64).image(true, false);
        if (dense == 0) {
            EXPECT_NEAR(image.find("depth")->pixels[0], 7, 1e-3);
            EXPECT_NEAR(image.find("albedo")->pixels[0], 0.25, 1e-4);
        }
        ASSERT_EQ(image.layers[0].channels.size(), 4u);
        EXPECT_EQ(image.layers[0].pixels[3], 1) << dense;
    }
}

}  // namespace
}  // namespace fathom
