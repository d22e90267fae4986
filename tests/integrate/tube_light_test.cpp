// SPDX-License-Identifier: Apache-2.0
/// Tests of tubes against the sum over their side.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

/// Irradiance at the origin of a floor with normal +y, by summing over the side of a cylinder along z that `place`
/// maps by a similarity.
double tube_irradiance(const Transform& place, double length_z, double radius)
{
    constexpr int n = 800;
    const double scale = length(place.vector({1, 0, 0}));
    const double area = 2 * std::numbers::pi * radius * length_z * scale * scale / (n * n);
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double turn = 2 * std::numbers::pi * (i + 0.5) / n;
            const Vec3d out{std::cos(turn), std::sin(turn), 0};
            const Vec3d q = place.point(out * radius + Vec3d{0, 0, ((j + 0.5) / n - 0.5) * length_z}),
                        normal = normalize(place.vector(out));
            const double d2 = dot(q, q), facing = -dot(normal, q);
            if (facing > 0 && q.y > 0) sum += facing * q.y / (d2 * d2) * area;
        }
    return sum;
}

/// Tubes of given radiance or flux light a floor as calculated, near and far, rotated and scaled, at rest and in a
/// moving node.
TEST(Lights, Tubes)
{
    for (const double scale : {1.0, 2.5})
        for (const double height : {0.3, 2.0})
            for (const bool is_flux : {false, true})
                for (const bool moves : {false, true}) {
                    const Transform place = Transform::translate({0.4, height * scale, -0.2}) *
                                            Transform::rotate({1, 2, 0.5}, 0.7) *
                                            Transform::scale({scale, scale, scale});
                    SceneBuilder b = floor_scene(0.5f, 0.06);
                    Light light;
                    light.kind = LightKind::tube;
                    light.length = 0.5, light.radius = 0.04;
                    light.intensity = {5, 5, 5};
                    light.intensity_is_flux = is_flux;
                    b.light(light, place);
                    if (moves) {
                        // The tube turns about its own axis, so its light is the same at every time.
                        b.scene.cameras[0].shutter_close = 1;
                        b.scene.nodes.back().motion = {{0, place}, {1, place * Transform::rotate({0, 0, 1}, 1)}};
                    }
                    const double side = 2 * std::numbers::pi * 0.04 * 0.5 * scale * scale;
                    const double radiance = is_flux ? 5 / (std::numbers::pi * side) : 5;
                    SCOPED_TRACE(std::to_string(scale) + " " + std::to_string(height) + (is_flux ? " lm" : "") +
                                 (moves ? " moves" : ""));
                    expect_mean(render_film(b.scene, small_image_settings(16, 16), 64),
                                0.5 / std::numbers::pi * radiance * tube_irradiance(place, 0.5, 0.04), 0.005);
                }
}

/// The tree selects tubes among other lights with the correct probability, and objects in between block their light.
TEST(Lights, TubesBesideOthersAndShadowsOfTubes)
{
    const Transform place = Transform::translate({0.5, 1, 0.2}) * Transform::rotate({0, 1, 0}, 1);
    SceneBuilder b = floor_scene(0.5f, 0.06);
    b.scene.cameras[0].position = {0.3, 0.4, 0};
    Light light;
    double expected = 0;
    for (int i = 0; i < 30; ++i) {
        const Vec3d at{0.2 * i - 3, 2, 0.1 * i};
        light.intensity = {0.2f, 0.2f, 0.2f};
        b.light(light, Transform::translate(at));
        expected += 0.2 * at.y / std::pow(length(at), 3);
    }
    light.kind = LightKind::tube;
    light.intensity = {5, 5, 5};
    light.radius = 0.05;
    b.light(light, place);
    expected += 5 * tube_irradiance(place, 1, 0.05);
    for (const LightSelection how : {LightSelection::tree, LightSelection::power, LightSelection::uniform}) {
        RenderSettings settings = small_image_settings(8, 8);
        settings.light_selection = how;
        expect_mean(render_film(b.scene, settings, 4096), 0.5 / std::numbers::pi * expected, 0.02);
    }
    SceneBuilder dark = floor_scene(0.5f, 0.06);
    dark.scene.cameras[0].position = {0.3, 0.4, 0};
    dark.light(light, place);
    dark.add(Rectangle{{-9, 0.7, -9}, {18, 0, 0}, {0, 0, 18}}, dark.diffuse(0));
    expect_mean(render_film(dark.scene, small_image_settings(4, 4), 4), 0, 1e-6);
}

}  // namespace
}  // namespace fathom
