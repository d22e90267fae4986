// SPDX-License-Identifier: Apache-2.0
// Tests of caustics that camera paths gather from photons.
#include "image/pictures.h"
#include "light_tracing_scenes.h"

namespace fathom {
namespace {

using namespace test;

using std::numbers::pi;

/// Fresnel transmittance of a boundary of index 1.5 from outside.
double transmittance(double cosine)
{
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / 2.25);
    const double s = (cosine - 1.5 * inside) / (cosine + 1.5 * inside),
                 p = (inside - 1.5 * cosine) / (inside + 1.5 * cosine);
    return 1 - (s * s + p * p) / 2;
}

RenderSettings gathering(int max_depth = -1)
{
    RenderSettings s = traced();
    s.light_paths = 64;
    s.merge_caustics = true;
    s.max_depth = max_depth;
    return s;
}

/// A floor of reflectance 1/2 below a thick pane of glass, which an orthographic camera sees through the pane.
struct FloorBelowPane : SeenFloor {
    explicit FloorBelowPane(int spheres = 1) : SeenFloor(spheres, 1.2)
    {
        add(Box{{-1.2, 0.5, -1.2}, {1.2, 0.6, 1.2}}, material(dielectric()));
        scene.cameras[0].position = {0, 1, 0};
    }
    FloorBelowPane& with_sun(double angle)
    {
        Light sun;
        sun.kind = LightKind::directional;
        light(sun, rotate_to({std::sin(angle), -std::cos(angle), 0}));
        return *this;
    }
    FloorBelowPane& with_lamp(float radiance = 1)
    {
        add(Rectangle{{-1.2, 1.2, -1.2}, {2.4, 0, 0}, {0, 0, 2.4}}, material(lamp_of(radiance)));
        return *this;
    }
};

/// Surfaces that scatter the light: two of the pane, the floor, and two of the pane.
constexpr int surfaces = 5;

TEST(CausticPhotons, SunThroughAPane)
{
    for (const int spheres : {1, 100})
        for (const double angle : {0.0, 0.6}) {
            FloorBelowPane b(spheres);
            b.with_sun(angle);
            const double cosine = std::cos(angle), through = std::pow(transmittance(cosine), 2),
                         back = std::pow(transmittance(1), 2);
            expect_mean(render_film(b.scene, gathering(surfaces), 64), cosine * through * back * 0.5 / pi, 0.01);
        }
}

/// The pane lifts the lamp by its thickness times 1 - 1 / n, seen from the square, which is small and far below.
TEST(CausticPhotons, PointThroughAPane)
{
    FloorBelowPane b;
    b.point_light({1, 1, 1}, {0, 4, 0});
    const double height = 4 - 0.1 * (1 - 1 / 1.5), passed = std::pow(transmittance(1), 4);
    // The mean over the square of cos^3 / height^2, to second order.
    const double irradiance = passed / (height * height) * (1 - 1.5 * (1. / 6) / (height * height));
    expect_mean(render_film(b.scene, gathering(surfaces), 64), irradiance * 0.5 / pi, 0.015);
}

TEST(CausticPhotons, DepthLimit)
{
    FloorBelowPane b;
    b.with_sun(0.3);
    expect_mean(render_film(b.scene, gathering(surfaces - 1), 4), 0, 0);
}

/// Path tracing finds lamps of some size through glass, too.
void expect_as_path_tracing(const SceneDescription& scene, int max_depth, double tolerance, double light_paths = 64)
{
    RenderSettings plain = gathering(max_depth), merged = plain;
    plain.light_paths = 0, merged.light_paths = light_paths;
    const Mean by_rays = mean_of(render_film(scene, plain, 4096)), gathered = mean_of(render_film(scene, merged, 128));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(gathered.value[c], by_rays.value[c],
                    4 * std::hypot(gathered.error[c], by_rays.error[c]) + tolerance * by_rays.value[c]);
}

TEST(CausticPhotons, LampThroughAPane)
{
    FloorBelowPane b;
    b.with_lamp();
    expect_as_path_tracing(b.scene, surfaces, 0.015);
}

/// Light that meets no glass leaves no photons: light samples find it.
TEST(CausticPhotons, LampBelowThePane)
{
    FloorBelowPane b;
    b.point_light({0.1f, 0.1f, 0.1f}, {0.7, 0.4, 0});
    // The limit leaves out what the pane reflects to the floor, which rays do not find.
    expect_as_path_tracing(b.scene, 3, 0.01);
}

/// Caustics that are seen directly are weighted between rays and connections, without photons.
TEST(CausticPhotons, SeenFromBelowThePane)
{
    FloorBelowPane b;
    b.with_lamp();
    b.scene.cameras[0].position = {0, 0.4, 0};
    // With so few light paths, rays have most of the weight.
    expect_as_path_tracing(b.scene, -1, 0.01, 0.1);
}

/// After mirrors, in all orders, and without a limit of depth.
TEST(CausticPhotons, RoomSeenInAMirror)
{
    Room b;
    b.with_smooth_objects().with_lamp();
    b.add(Rectangle{{-1, 0, -0.9}, {2, 0, 0}, {0, 2, 0}}, b.material(conductor(0, 0.9f)));
    expect_as_path_tracing(b.scene, -1, 0.015);
}

/// Camera paths that a medium scatters first gather photons as well.
TEST(CausticPhotons, Fog)
{
    FloorBelowPane b;
    b.with_lamp();
    Material fog;
    fog.kind = MaterialKind::glass;
    fog.ior = 1;
    fog.interior.attenuation_distance = 0.4;
    fog.interior.attenuation_color = {0.4f, 0.4f, 0.4f};
    fog.interior.scatter = {0.9f, 0.9f, 0.9f};
    b.add(Box{{-1.1, 0.01, -1.1}, {1.1, 0.45, 1.1}}, b.material(fog));
    expect_as_path_tracing(b.scene, -1, 0.02);
}

/// Light paths do not start at a constant environment, so its light is left to path tracing.
TEST(CausticPhotons, Sky)
{
    FloorBelowPane b;
    b.scene.environment = uniform_sky();
    expect_as_path_tracing(b.scene, -1, 0.01);
}

/// The sun of an environment image is gathered, the rest of the image is left to path tracing.
TEST(CausticPhotons, SunInAnEnvironment)
{
    const TemporaryFolder folder;
    Image image = make_test_image(64, 32, {"R", "G", "B"}, 0.4f);
    for (int c = 0; c < 3; ++c) image.layers[0].pixels[std::size_t((6 * 64 + 40) * 3 + c)] = 400;
    write_image(folder.path() / "sky.exr", image, {});
    FloorBelowPane b;
    b.scene.images.push_back({"sky", folder.path() / "sky.exr", {}});
    b.scene.environment.kind = EnvironmentKind::image;
    b.scene.environment.image = 0;
    expect_as_path_tracing(b.scene, surfaces, 0.02);
}

TEST(CausticPhotons, LightThatOnlyPhotonsShow)
{
    const auto fraction = [](const FloorBelowPane& b, double light_paths) {
        RenderSettings settings = traced(60, 60);
        settings.light_paths = light_paths;
        Warnings warnings;
        return light_of_photons(RenderJob(Scene::compile(b.scene, "", warnings), settings));
    };
    FloorBelowPane through, below;
    through.with_sun(0.3);
    below.with_sun(0.3).scene.cameras[0].position = {0, 0.4, 0};
    EXPECT_GT(fraction(through, 1), 0.9);
    EXPECT_EQ(fraction(through, 0), 0);
    EXPECT_LT(fraction(below, 1), 0.02);
}

TEST(CausticPhotons, KeyTellsWhatWasGathered)
{
    FloorBelowPane b;
    b.with_sun(0.3);
    const Film merged = render_film(b.scene, gathering(), 1), separate = render_film(b.scene, traced(), 1);
    EXPECT_NE(merged.key().text(), separate.key().text());
    EXPECT_EQ(FilmKey::parse(merged.key().text()).text(), merged.key().text());
    EXPECT_TRUE(FilmKey::parse(merged.key().text()).settings.merge_caustics);
    EXPECT_NE(merged.key().difference(separate.key()), "");
}

}  // namespace
}  // namespace fathom
