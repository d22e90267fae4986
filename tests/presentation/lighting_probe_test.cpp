// SPDX-License-Identifier: Apache-2.0
#include "fathom/lighting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "seen_from.h"
#include "support/placed_light.h"

// Tests of automatic light and exposure for scenes with known illumination.
namespace fathom {
namespace {

/// A camera at (0, 0, 6) that looks along -z at an object at the origin.
class LightingProbeTest : public ::testing::Test {
protected:
    SceneDescription d = test::model_viewed_from({0, 0, 6});
    Warnings warnings;

    LightingProbeTest()
    {
        d.materials[0].base_color.value = {0.5f, 0.5f, 0.5f};
        d.nodes[0].shapes.push_back({Sphere{{0, 0, 0}, 1.5, {}}, 0, ""});
    }
    /// The sun emits along -z, the camera's view direction.
    void add_sun(float lux, const Transform& turn = {})
    {
        Light sun;
        sun.kind = LightKind::directional;
        sun.intensity = {lux, lux, lux};
        test::add_light(d, sun, turn);
    }
    int add_lamp(Color radiance)
    {
        d.materials.emplace_back();
        d.materials.back().kind = MaterialKind::none;
        d.materials.back().emission.radiance.value = radiance;
        return int(d.materials.size()) - 1;
    }
    LightingProbe look() { return probe_lighting(Scene::compile(d, "", warnings), 1); }
    LitScene lit(LightingMode choice = LightingMode::automatic) { return compile_lit(d, "", choice, 1, warnings); }
};

/// A low sun gets an exposure but no studio lights.
TEST_F(LightingProbeTest, ExposesForAnEveningSky)
{
    d.environment.kind = EnvironmentKind::sky;
    d.environment.to_sun = {-0.5, 0.05, 0.5};
    const LitScene evening = lit(LightingMode::file);
    EXPECT_FALSE(evening.studio);
    EXPECT_GT(evening.exposure_ev.value_or(0), 1);
    d.environment.to_sun = {-0.5, 0.6, 0.5};
    EXPECT_LT(lit(LightingMode::file).exposure_ev.value_or(0), 1);
}

/// A sphere that is lit from the camera has radiance albedo / pi * cosine * illuminance; half of its disk has a cosine
/// above sqrt(0.5), 5 % above sqrt(0.95).
TEST_F(LightingProbeTest, MeasuresASphereInTheSun)
{
    add_sun(10);
    d.cameras[0].kind = CameraKind::orthographic;
    d.cameras[0].height = 4;
    const LightingProbe seen = look();
    const double most = 0.5 / std::acos(-1.0) * 10;
    EXPECT_NEAR(seen.middle, most * std::sqrt(0.5), 0.04 * most);
    EXPECT_NEAR(seen.bright, most * std::sqrt(0.95), 0.02 * most);
    EXPECT_GT(seen.lit, 0.97);
    EXPECT_NEAR(seen.covered, std::acos(-1.0) * 1.5 * 1.5 / 16, 0.03);
}

/// Visible lights, unlit materials and the background are ignored.
TEST_F(LightingProbeTest, LampsInViewDoNotCount)
{
    add_sun(10);
    const LightingProbe before = look();
    const int lamp = add_lamp({30, 30, 30});
    d.nodes[0].shapes.push_back({Rectangle{{1.9, 1.2, -3}, {1.2, 0, 0}, {0, 1.2, 0}}, lamp, ""});
    d.environment.kind = EnvironmentKind::none;
    const LightingProbe after = look();
    EXPECT_NEAR(after.middle, before.middle, 0.05 * before.middle);
    EXPECT_NEAR(after.bright, before.bright, 0.2 * before.bright);
    EXPECT_NEAR(after.exposure_ev(), before.exposure_ev(), 0.2);
}

TEST_F(LightingProbeTest, ExposesForTheLightOfTheFile)
{
    for (const double lux : {0.001, 3.0, 100000.0}) {
        SceneDescription dark = d;
        add_sun(float(lux));
        const LitScene scene = lit();
        d = dark;
        EXPECT_FALSE(scene.studio) << lux;
        // Exposure is the smaller of 0.22 over the median and 1 over the maximum, here the former.
        const double stops = std::log2(0.22 / (0.5 / std::acos(-1.0) * lux * std::sqrt(0.5)));
        if (std::abs(stops) < 1.2)
            EXPECT_FALSE(scene.exposure_ev.has_value()) << lux;
        else
            EXPECT_NEAR(scene.exposure_ev.value_or(0), stops, 0.5) << lux;
    }
    add_sun(100000);
    d.hints.exposure = 0;
    EXPECT_FALSE(lit().exposure_ev.has_value());
}

/// Automatic light is kept when the scene is edited, and equals that of the scene alone.
TEST_F(LightingProbeTest, EditsKeepTheirLight)
{
    add_sun(100000);
    for (const LightingMode choice : {LightingMode::automatic, LightingMode::studio}) {
        EditableScene edit(d);
        LitScene first = compile_lit(edit, choice, 1, warnings);
        EXPECT_EQ(first.scene.fingerprint(), lit(choice).scene.fingerprint());
        EXPECT_EQ(first.studio, choice == LightingMode::studio);
        EXPECT_EQ(first.exposure_ev.has_value(), choice == LightingMode::automatic);
        first.scene = {};
        edit.set_transform(0, Transform::translate({0.1, 0, 0}));
        const Scene moved = edit.compile_bit_exact(warnings);
        EXPECT_EQ(edit.description().environment.kind == EnvironmentKind::studio, choice == LightingMode::studio);
        EXPECT_EQ(moved.fingerprint(), Scene::compile(edit.description(), "", warnings).fingerprint());
        // A removed sun stays removed.
        EXPECT_EQ(edit.description().nodes.back().light < 0, choice == LightingMode::studio);
    }
}

TEST_F(LightingProbeTest, AddsAStudioWithoutLights)
{
    const LitScene scene = lit();
    EXPECT_TRUE(scene.studio);
    ASSERT_EQ(scene.added.size(), 1u);
    // A gray sphere in the studio is neither dark nor overexposed.
    const LightingProbe seen = probe_lighting(scene.scene, 1);
    EXPECT_GT(seen.lit, 0.99);
    EXPECT_GT(seen.middle, 0.1);
    EXPECT_LT(seen.bright, 1);
    const LitScene bare = lit(LightingMode::file);
    EXPECT_FALSE(bare.studio);
    EXPECT_EQ(probe_lighting(bare.scene, 1).bright, 0);
}

/// A weak emission or a light behind the subject leaves it dark, so studio lights are added.
TEST_F(LightingProbeTest, AddsAStudioWhereLightReachesLittle)
{
    const SceneDescription dark = d;
    const int led = add_lamp({2, 0, 0});
    d.nodes[0].shapes.push_back({Sphere{{0.4, 0.4, 1.45}, 0.05, {}}, led, ""});
    LitScene scene = lit();
    EXPECT_TRUE(scene.studio);
    EXPECT_FALSE(scene.exposure_ev.has_value());
    EXPECT_GT(scene.scene.statistics().lights, 1u);  // the lights are the sky and the small emissive surface

    d = dark;
    add_sun(5, Transform::rotate({0, 1, 0}, std::acos(-1.0)));
    EXPECT_TRUE(lit().studio);
    EXPECT_FALSE(lit(LightingMode::file).studio);
    d.hints.own_light = true;
    EXPECT_FALSE(lit().studio);
}

/// A dim emissive wall lights the whole model, but the exposure ignores it.
TEST_F(LightingProbeTest, DimSurfacesAreDecoration)
{
    const int panel = add_lamp({0.05f, 0.05f, 0.05f});
    d.nodes[0].shapes.push_back({Rectangle{{4, -4, 8}, {-8, 0, 0}, {0, 8, 0}}, panel, ""});
    EXPECT_TRUE(lit().studio);
    d.materials[std::size_t(panel)].emission.radiance.value = {3, 3, 3};
    EXPECT_FALSE(lit().studio);
}

/// The key light is left of the camera for any camera position.
TEST_F(LightingProbeTest, StudioTurnsWithTheCamera)
{
    for (const double angle : {0.0, 1.0, 2.5, -1.5}) {
        d.cameras[0].position = {6 * std::sin(angle), 0, 6 * std::cos(angle)};
        RenderSettings settings;
        settings.width = settings.height = 32;
        settings.background = Color{0, 0, 0};
        const RenderJob job(lit(LightingMode::studio).scene, settings);
        Film film(job);
        render(job, {0, 16}, film);
        const Image image = film.image(false, false);
        double left = 0, right = 0;
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x)
                (x < 16 ? left : right) += double(image.layers[0].pixels[std::size_t(3 * (32 * y + x))]);
        EXPECT_GT(left, 1.2 * right) << angle;
    }
}

/// Unlit models are shown unchanged.
TEST_F(LightingProbeTest, KeepsUnlitModels)
{
    d.materials[0].kind = MaterialKind::unlit;
    const LitScene scene = lit();
    EXPECT_FALSE(scene.studio);
    EXPECT_FALSE(scene.exposure_ev.has_value());
    EXPECT_TRUE(scene.backdrop);
}

}  // namespace
}  // namespace fathom
