// SPDX-License-Identifier: Apache-2.0
// Tests of lights that are hidden from the camera, and of lights that no ray hits.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

using std::numbers::pi;

Material lamp(float radiance)
{
    Material m;
    m.kind = MaterialKind::none;
    m.emission.radiance.value = {radiance, radiance, radiance};
    return m;
}

/// A small floor of reflectance 1/2 below a square 2 x 2 light at height 1, seen from above through the light.
struct LitFloor : SceneBuilder {
    explicit LitFloor(const Material& light)
    {
        add(Rectangle{{-1e-3, -1e-3, 0}, {2e-3, 0, 0}, {0, 2e-3, 0}}, diffuse(0.5f));
        add(Rectangle{{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}}, material(light));
        camera({0, 0, 5}, {0, 0, 0}, 0.01);
    }
};

/// Irradiance at distance 1 below the center of a square of half width 1 with unit radiosity: four times the form
/// factor of a quarter (Cohen and Wallace 1993, parallel rectangle seen from a corner).
double radiosity()
{
    const double x = 1, y = 1, a = std::sqrt(1 + x * x), b = std::sqrt(1 + y * y);
    return 4 * (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2 * pi);
}

TEST(LampVisibility, CamerasLookThroughHiddenLamps)
{
    Material light = lamp(3);
    expect_mean(render_film(LitFloor(light).scene, small_image_settings(4, 4), 64), 0);
    light.visibility.hidden_from_camera = true;
    expect_mean(render_film(LitFloor(light).scene, small_image_settings(4, 4), 1024), 0.5 * 3 * radiosity());
    // A hidden light is also invisible from its front.
    LitFloor turned(light);
    turned.scene.nodes[0].shapes[1].geometry = Rectangle{{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}};
    expect_mean(render_film(turned.scene, small_image_settings(4, 4), 64), 0);
}

TEST(LampVisibility, NoRayHitsInvisibleLights)
{
    Material light = lamp(3);
    light.visibility.invisible_light = true;
    const double expected = 0.5 * 3 * radiosity();
    expect_mean(render_film(LitFloor(light).scene, small_image_settings(4, 4), 1024), expected);
    // Alpha does not change an invisible light.
    light.opacity.mode = AlphaMode::blend;
    for (const float alpha : {0.f, 0.5f}) {
        light.opacity.alpha.value = alpha;
        expect_mean(render_film(LitFloor(light).scene, small_image_settings(4, 4), 1024), expected);
    }
    // Nor does it if a texture varies the emission.
    LitFloor textured(light);
    Texture even;
    even.kind = TextureKind::checker_uv;
    even.color_a.value = even.color_b.value = {1, 1, 1};
    textured.scene.textures.push_back(even);
    textured.scene.materials.back().emission.radiance.texture = 0;
    expect_mean(render_film(textured.scene, small_image_settings(4, 4), 1024), expected);
    // The light occludes nothing: another light above it contributes too.
    LitFloor two(light);
    two.add(Rectangle{{-2, -2, 2}, {0, 4, 0}, {4, 0, 0}}, two.material(light));
    expect_mean(render_film(two.scene, small_image_settings(4, 4), 2048), 2 * expected);
}

/// A mirror shows lights that are hidden from the camera, but not invisible lights.
TEST(LampVisibility, InMirrors)
{
    for (const bool is_hidden : {true, false}) {
        Material light = lamp(3), mirror;
        light.visibility.hidden_from_camera = is_hidden, light.visibility.invisible_light = !is_hidden;
        mirror.kind = MaterialKind::metal;
        mirror.base_color.value = {1, 1, 1};
        LitFloor scene(light);
        scene.scene.nodes[0].shapes[0].material = scene.material(mirror);
        expect_mean(render_film(scene.scene, small_image_settings(4, 4), 64), is_hidden ? 3 : 0);
    }
}

/// A sphere of radius r at distance d straight above contributes L (r / d)^2, whether rays hit it or not. Light samples
/// of a large sphere compete with scattered rays only if these hit it.
TEST(LampVisibility, InvisibleBalls)
{
    for (const bool is_invisible : {false, true})
        for (const double radius : {0.5, 1.5}) {
            Material light = lamp(10);
            light.visibility.invisible_light = is_invisible;
            SceneBuilder scene;
            scene.add(Rectangle{{-1e-3, -1e-3, 0}, {2e-3, 0, 0}, {0, 2e-3, 0}}, scene.diffuse(1));
            scene.add(Sphere{{0, 0, 2}, radius, {}}, scene.material(light));
            scene.camera({1, 0, 0.2}, {0, 0, 0}, 0.01);
            expect_mean(render_film(scene.scene, small_image_settings(4, 4), 1024), 10 * radius * radius / 4, 0.003);
        }
}

}  // namespace
}  // namespace fathom
