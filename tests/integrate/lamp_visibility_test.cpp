// Lamps that cameras look through, and lamps that no ray meets.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

Material lamp(float radiance)
{
    Material m;
    m.kind = MaterialKind::none;
    m.emission.value = {radiance, radiance, radiance};
    return m;
}

/// A small floor of reflectance 1/2 below a square lamp of 2 by 2, 1 above it, seen from above through the lamp.
struct LitFloor : SceneBuilder {
    explicit LitFloor(const Material& light)
    {
        add(Rectangle{{-1e-3, -1e-3, 0}, {2e-3, 0, 0}, {0, 2e-3, 0}}, diffuse(0.5f));
        add(Rectangle{{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}}, material(light));
        camera({0, 0, 5}, {0, 0, 0}, 0.01);
    }
};

/// What a square of a unit's half width sends down to a place a unit below its middle: four times the form factor of a
/// quarter of it (Cohen and Wallace 1993, the parallel rectangle seen from a corner).
double radiosity()
{
    const double x = 1, y = 1, a = std::sqrt(1 + x * x), b = std::sqrt(1 + y * y);
    return 4 * (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2 * pi);
}

TEST(LampVisibility, CamerasLookThroughHiddenLamps)
{
    Material light = lamp(3);
    expect_mean(render_film(LitFloor(light).scene, small_picture(4, 4), 64), 0);
    light.hidden_from_camera = true;
    expect_mean(render_film(LitFloor(light).scene, small_picture(4, 4), 1024), 0.5 * 3 * radiosity());
    // From in front as well.
    LitFloor turned(light);
    turned.scene.nodes[0].shapes[1].geometry = Rectangle{{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}};
    expect_mean(render_film(turned.scene, small_picture(4, 4), 64), 0);
}

TEST(LampVisibility, NoRayMeetsInvisibleLights)
{
    Material light = lamp(3);
    light.invisible_light = true;
    const double expected = 0.5 * 3 * radiosity();
    expect_mean(render_film(LitFloor(light).scene, small_picture(4, 4), 1024), expected);
    // Whatever its alpha says.
    light.alpha_mode = AlphaMode::blend;
    for (const float alpha : {0.f, 0.5f}) {
        light.alpha.value = alpha;
        expect_mean(render_film(LitFloor(light).scene, small_picture(4, 4), 1024), expected);
    }
    // It hides nothing: another lamp above it counts as well.
    LitFloor two(light);
    two.add(Rectangle{{-2, -2, 2}, {0, 4, 0}, {4, 0, 0}}, two.material(light));
    expect_mean(render_film(two.scene, small_picture(4, 4), 2048), 2 * expected);
}

/// A mirror shows lamps that are hidden from the camera, and none that no ray meets.
TEST(LampVisibility, InMirrors)
{
    for (const bool is_hidden : {true, false}) {
        Material light = lamp(3), mirror;
        light.hidden_from_camera = is_hidden, light.invisible_light = !is_hidden;
        mirror.kind = MaterialKind::metal;
        mirror.base_color.value = {1, 1, 1};
        LitFloor scene(light);
        scene.scene.nodes[0].shapes[0].material = scene.material(mirror);
        expect_mean(render_film(scene.scene, small_picture(4, 4), 64), is_hidden ? 3 : 0);
    }
}

/// A round lamp and one of triangles shine alike where they are invisible.
TEST(LampVisibility, InvisibleBalls)
{
    for (const bool is_invisible : {false, true}) {
        Material light = lamp(10);
        light.invisible_light = is_invisible;
        SceneBuilder scene;
        scene.add(Rectangle{{-1e-3, -1e-3, 0}, {2e-3, 0, 0}, {0, 2e-3, 0}}, scene.diffuse(1));
        scene.add(Sphere{{0, 0, 2}, 0.5, {}}, scene.material(light));
        scene.camera({1, 0, 1}, {0, 0, 0}, 0.01);
        // A ball of radius r at a distance d straight above sends L (r / d)^2.
        expect_mean(render_film(scene.scene, small_picture(4, 4), 1024), 10.0 / 16, 0.003);
    }
}

}  // namespace
}  // namespace fathom
