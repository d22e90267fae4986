// SPDX-License-Identifier: Apache-2.0
/// Tests of the irradiance of a floor by each kind of light, against closed forms.
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

TEST(Lights, SphereOverAPlane)
{
    // E = pi L (r / d)^2 cos, exact while the sphere is entirely above the horizon.
    for (bool light_sampling : {true, false}) {
        SceneBuilder b = floor_scene(0.5f, 0.5);
        b.add(Sphere{{1.5, 3, 0}, 1, {}}, b.diffuse(0, {4, 4, 4}));
        RenderSettings settings = small_image_settings(16, 16);
        settings.light_sampling = light_sampling;
        const double d2 = 1.5 * 1.5 + 9, cosine = 3 / std::sqrt(d2);
        expect_mean(render_film(b.scene, settings, light_sampling ? 64 : 4096), 0.5 * 4 / d2 * cosine, 0.003);
    }
}

/// Configuration factor of an a x c rectangle parallel to the floor with a corner at height h above the point (Howell,
/// C-11).
double rectangle_factor(double a, double c, double h)
{
    const double x = a / h, y = c / h, sx = std::sqrt(1 + x * x), sy = std::sqrt(1 + y * y);
    return (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy)) / (2 * std::numbers::pi);
}

TEST(Lights, RectangleOverAPlane)
{
    const double a = 2, c = 1.5, h = 1.2;
    for (bool light_sampling : {true, false}) {
        SceneBuilder b = floor_scene(0.5f, 0.5);
        b.add(Rectangle{{0, h, 0}, {a, 0, 0}, {0, 0, c}}, b.diffuse(0, {3, 3, 3}, true));
        b.scene.cameras[0].position = {-0.5, 0.5, -0.5};
        RenderSettings settings = small_image_settings(16, 16);
        settings.light_sampling = light_sampling;
        expect_mean(render_film(b.scene, settings, light_sampling ? 64 : 4096), 0.5 * 3 * rectangle_factor(a, c, h),
                    0.01);
    }
}

/// A light with a texture that is black in one half emits only from the other half, alone or beside another light.
TEST(Lights, TextureOfALamp)
{
    const double a = 2, c = 1.5, h = 1.2;
    for (bool is_alone : {true, false})
        for (bool light_sampling : {true, false}) {
            SceneBuilder b = floor_scene(0.5f, 0.5);
            Texture halves;
            halves.kind = TextureKind::checker_uv;
            halves.uv_scale = {2, 1};
            halves.color_a.value = {1, 1, 1};
            halves.color_b.value = {0, 0, 0};
            b.scene.textures.push_back(halves);
            const int lamp = b.diffuse(0, {3, 3, 3}, true);
            b.scene.materials[std::size_t(lamp)].emission.radiance.texture = 0;
            b.add(Rectangle{{0, h, 0}, {2 * a, 0, 0}, {0, 0, c}}, lamp);
            if (!is_alone)
                b.add(Rectangle{{0, -1, 0}, {a, 0, 0}, {0, 0, c}}, lamp);  // an additional light below the floor
            b.scene.cameras[0].position = {-0.5, 0.5, -0.5};
            RenderSettings settings = small_image_settings(16, 16);
            settings.light_sampling = light_sampling;
            expect_mean(render_film(b.scene, settings, light_sampling ? 256 : 4096),
                        0.5 * 3 * rectangle_factor(a, c, h), 0.01);
        }
}

/// max_depth removes equal light paths with NEE and without, in the quad loop and in the general loop.
TEST(Lights, ALimitOfDepth)
{
    for (bool quads : {true, false})
        for (int max_depth : {0, 1, 2}) {
            Mean mean[2];
            for (bool light_sampling : {true, false}) {
                SceneBuilder b;
                const int gray = b.diffuse(0.5f);
                b.add(Rectangle{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}}, gray);
                b.add(Rectangle{{-2, 0, -2}, {4, 0, 0}, {0, 4, 0}}, gray);
                b.add(Rectangle{{-1, 3, -1}, {2, 0, 0}, {0, 0, 2}}, b.diffuse(0, {5, 5, 5}));
                if (!quads) b.add(Sphere{{1, 1, 0}, 0.5, {}}, gray);
                b.camera({0, 2, 6}, {0, 2, 0}, 50);
                RenderSettings settings = small_image_settings();
                settings.light_sampling = light_sampling;
                settings.max_depth = max_depth;
                mean[light_sampling] = mean_of(render_film(b.scene, settings, light_sampling ? 64 : 1024));
            }
            EXPECT_NEAR(mean[1].value[0], mean[0].value[0], 4 * (mean[1].error[0] + mean[0].error[0]) + 1e-6)
                << quads << " " << max_depth;
            EXPECT_GT(mean[0].value[0], max_depth == 0 ? 0 : 0.1);
        }
}

/// A light with opacity 1/4 emits a quarter; one with a cutout mask emits from what remains.
TEST(Lights, AlphaOfALamp)
{
    const double a = 2, c = 1.5, h = 1.2;
    Mesh mesh;  // opaque for x < a: the vertex alpha crosses the cutoff there
    for (int i = 0; i < 4; ++i) {
        mesh.positions.push_back({float(i & 1 ? 2 * a : 0), float(h), float(i & 2 ? c : 0)});
        mesh.colors.push_back({1, 1, 1, i & 1 ? 0.f : 1.f});
    }
    mesh.indices = {0, 1, 3, 0, 3, 2};
    for (bool cut_out : {false, true})
        for (bool light_sampling : {true, false}) {
            SceneBuilder b = floor_scene(0.5f, 0.5);
            const int lamp = b.diffuse(0, {3, 3, 3}, true);
            Material& m = b.scene.materials[std::size_t(lamp)];
            m.opacity.mode = cut_out ? AlphaMode::mask : AlphaMode::blend;
            m.opacity.alpha.value = cut_out ? 1 : 0.25f;
            m.use_vertex_color = true;
            b.scene.meshes.push_back(mesh);
            if (cut_out)
                b.add(MeshInstance{0}, lamp);
            else
                b.add(Rectangle{{0, h, 0}, {a, 0, 0}, {0, 0, c}}, lamp);
            b.scene.cameras[0].position = {-0.5, 0.5, -0.5};
            RenderSettings settings = small_image_settings(16, 16);
            settings.light_sampling = light_sampling;
            expect_mean(render_film(b.scene, settings, light_sampling ? 256 : 4096),
                        0.5 * 3 * rectangle_factor(a, c, h) * (cut_out ? 1 : 0.25), 0.01);
        }
}

TEST(Lights, DiskOverAPlane)
{
    // The disk has radius r and is centered at height h: E = pi L r^2 / (r^2 + h^2).
    SceneBuilder b = floor_scene(0.5f, 0.5);
    b.add(Disk{{0, 2, 0}, {0, -1, 0}, 1}, b.diffuse(0, {3, 3, 3}));
    b.scene.cameras[0].position = {0.3, 0.5, 0};
    expect_mean(render_film(b.scene, small_image_settings(16, 16), 1024), 0.5 * 3 / 5.0, 0.005);
}

TEST(Lights, PointSpotAndDirectional)
{
    const auto mean = [](const Light& light, Vec3d from) {
        SceneBuilder b = floor_scene(0.5f, 0.5);
        // The node's -z points down.
        b.light(light, Transform::translate(from) * Transform::rotate({1, 0, 0}, -std::numbers::pi / 2));
        return render_film(b.scene, small_image_settings(16, 16), 16);
    };
    Light light;
    light.intensity = {5, 5, 5};
    expect_mean(mean(light, {1, 2, 0}), 0.5 / std::numbers::pi * 5 / 5 * (2 / std::sqrt(5.0)), 0.005);
    light.kind = LightKind::directional;
    expect_mean(mean(light, {0, 0, 0}), 0.5 / std::numbers::pi * 5);
    // The light is a disk of directions so large that BSDF samples would often hit it if it were visible.
    light.angle = 1.2;
    expect_mean(mean(light, {0, 0, 0}), 0.5 / std::numbers::pi * 5);
    light.kind = LightKind::spot;
    light.inner_angle = 0.3;
    light.outer_angle = 0.6;
    expect_mean(mean(light, {0, 2, 0}), 0.5 / std::numbers::pi * 5 / 4);
    expect_mean(mean(light, {3, 2, 0}), 0, 0);
}

/// Spots of all widths, from tiny cones to more than a hemisphere, follow the formula of KHR_lights_punctual in double
/// precision, from the cone's center to beyond its edge.
TEST(Lights, SpotOfEveryWidth)
{
    const auto one_minus_cos = [](double a) { return 2 * std::sin(a / 2) * std::sin(a / 2); };
    for (double outer : {1e-4, 1e-2, 0.5, std::numbers::pi / 2, 2.0, 3.0})
        for (double inner : {0.0, 0.5, 1.0})
            for (double at : {0.0, 0.3, 0.75, 0.95, 1.1}) {
                if (at * outer > 3) continue;
                SceneBuilder b = floor_scene(0.5f, 0.5);
                b.scene.cameras[0].fov_y = outer * 1e-3;
                Light light;
                light.kind = LightKind::spot;
                light.intensity = {5, 5, 5};
                light.inner_angle = inner * outer;
                light.outer_angle = outer;
                // The light is above the visible point; its axis, the node's -z, is tilted away by the angle.
                b.light(light, Transform::translate({0, 2, 0}) * Transform::rotate({0, 0, 1}, at * outer) *
                                   Transform::rotate({1, 0, 0}, -std::numbers::pi / 2));
                const double edge = one_minus_cos(outer), falloff = edge - one_minus_cos(inner * outer),
                             inside = edge - one_minus_cos(at * outer);
                const double x = inside <= 0 ? 0 : inside >= falloff ? 1 : inside / falloff;
                SCOPED_TRACE("outer " + std::to_string(outer) + " inner " + std::to_string(inner) + " at " +
                             std::to_string(at));
                expect_mean(render_film(b.scene, small_image_settings(4, 4), 4), 0.5 / std::numbers::pi * 5 / 4 * x * x,
                            0.004);
            }
}

/// Beams: parallel light inside the area's perpendicular projection, with the cosine at the floor and no falloff, under
/// rotation, scale, mirroring and shear, near and far.
TEST(Lights, Beams)
{
    const auto expect_beam = [](const Transform& place, bool round) {
        SceneBuilder b = floor_scene(0.5f, 0.5);
        b.scene.cameras[0].fov_y = 1e-3;
        Light light;
        light.kind = LightKind::beam;
        light.intensity = {5, 5, 5};
        light.width = 1.6, light.height = 0.6;
        light.round = round;
        b.light(light, place);
        // This is the foot of the perpendicular in the area's coordinates, by the normal equations of least squares.
        const Vec3d u = place.vector({0.8, 0, 0}), v = place.vector({0, 0.3, 0}), from = -place.point({0, 0, 0});
        Vec3d n = normalize(cross(u, v));
        if (dot(n, place.vector({0, 0, -1})) < 0) n = -n;
        const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), all = uu * vv - uv * uv;
        const double x = (dot(from, u) * vv - dot(from, v) * uv) / all,
                     y = (dot(from, v) * uu - dot(from, u) * uv) / all;
        const bool inside = round ? x * x + y * y < 1 : std::max(std::abs(x), std::abs(y)) < 1;
        const double expected = inside && dot(from, n) > 0 ? 0.5 / std::numbers::pi * 5 * std::max(0.0, -n.y) : 0;
        SCOPED_TRACE(std::to_string(x) + " " + std::to_string(y) + (round ? " round" : ""));
        expect_mean(render_film(b.scene, small_image_settings(4, 4), 4), expected, 1e-4);
        return expected > 0;
    };
    int lit = 0, dark = 0;
    for (const bool round : {false, true})
        for (const double x : {-0.83, -0.77, 0.1, 0.6, 0.83})
            for (const double y : {-0.31, -0.2, 0.05, 0.29})
                for (const double height : {0.01, 2.0, 300.0, -1.0})
                    for (const Transform& form :
                         {Transform(), Transform::rotate({0.3, 1, 0.2}, 0.4), Transform::scale({-1, 1.5, 2}),
                          Transform::rotate({0, 0, 1}, 0.5) * Transform::scale({1, 2, 1}) *
                              Transform::rotate({1, 0, 1}, 0.3)}) {
                        // The node's -z points down; the visible point has this distance from the area's center along
                        // its axis.
                        const Transform down = Transform::rotate({1, 0, 0}, -std::numbers::pi / 2) * form;
                        const Vec3d u = down.vector({1, 0, 0}), v = down.vector({0, 1, 0});
                        Vec3d n = normalize(cross(u, v));
                        if (dot(n, down.vector({0, 0, -1})) < 0) n = -n;
                        ++(expect_beam(Transform::translate(-(u * x + v * y + n * height)) * down, round) ? lit : dark);
                    }
    EXPECT_GT(lit, 100);
    EXPECT_GT(dark, 100);
}

/// Beams among few or many other lights are selected with the correct probability.
TEST(Lights, BeamsBesideOthers)
{
    for (const int others : {1, 40}) {
        SceneBuilder b = floor_scene(0.5f, 0.5);
        b.scene.cameras[0].fov_y = 1e-3;
        const Transform down = Transform::rotate({1, 0, 0}, -std::numbers::pi / 2);
        Light light;
        light.intensity = {3, 3, 3};
        double expected = 5;
        for (int i = 0; i < others; ++i) {
            const Vec3d at{0.2 * i - 1, 2, 0.1 * i};
            b.light(light, Transform::translate(at));
            expected += 3 * at.y / std::pow(length(at), 3);
        }
        light.kind = LightKind::beam;
        light.intensity = {5, 5, 5};
        light.width = light.height = 0.1;
        b.light(light, Transform::translate({0, 3, 0}) * down);
        for (const LightSelection how : {LightSelection::tree, LightSelection::power, LightSelection::uniform}) {
            RenderSettings settings = small_image_settings(8, 8);
            settings.light_selection = how;
            expect_mean(render_film(b.scene, settings, 4096), 0.5 / std::numbers::pi * expected,
                        how == LightSelection::tree ? 0.01 : 0.03);
        }
    }
}

/// An object between the area and a point blocks the beam; one behind the area does not.
TEST(Lights, ShadowsOfBeams)
{
    for (const double height : {0.5, 1.5}) {
        SceneBuilder b = floor_scene(0.5f, 0.5);
        b.scene.cameras[0].fov_y = 1e-3;
        b.scene.cameras[0].position = {0.3, 0.4, 0};
        Light light;
        light.kind = LightKind::beam;
        light.intensity = {5, 5, 5};
        b.light(light, Transform::translate({0, 1, 0}) * Transform::rotate({1, 0, 0}, -std::numbers::pi / 2));
        // An object in the plane of the area does not block it either, such as the emitting surface itself.
        b.add(Rectangle{{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}}, b.diffuse(0));
        b.add(Rectangle{{-0.2, height, -0.2}, {0.4, 0, 0}, {0, 0, 0.4}}, b.diffuse(0));
        expect_mean(render_film(b.scene, small_image_settings(4, 4), 4), height < 1 ? 0 : 0.5 / std::numbers::pi * 5,
                    1e-4);
    }
}

/// Vanishing angles give finite light: a directional light keeps its irradiance; a spot light emits only along its
/// axis.
TEST(Lights, AnglesNearZero)
{
    for (double angle : {1e-4, 1e-6, 1e-7, 1e-12, 1e-20, 1e-40, 0.0}) {
        SCOPED_TRACE(angle);
        for (LightKind kind : {LightKind::directional, LightKind::spot}) {
            SceneBuilder b = floor_scene(0.5f, 0.5);
            Light light;
            light.kind = kind;
            light.intensity = {5, 5, 5};
            light.angle = light.inner_angle = light.outer_angle = angle;
            b.light(light, Transform::translate({0, 2, 0}) * Transform::rotate({1, 0, 0}, -std::numbers::pi / 2));
            const Film film = render_film(b.scene, small_image_settings(4, 4), 4);
            if (kind == LightKind::directional)
                expect_mean(film, 0.5 / std::numbers::pi * 5);
            else
                EXPECT_LE(mean_of(film).value[0], 0.5 / std::numbers::pi * 5 / 4 * 1.001);
        }
    }
}

TEST(Lights, ManyOfThemAddUp)
{
    SceneBuilder b = floor_scene(0.5f, 0.5);
    double expected = 0;
    for (int i = 0; i < 20; ++i) {
        const double x = 0.4 * i - 4, e = 1 + i % 3;
        // The spheres are too small to occlude each other.
        b.add(Sphere{{x, 3, 1}, 0.05 + 0.002 * i, {}}, b.diffuse(0, {float(e), float(e), float(e)}));
        const double d2 = x * x + 10, r = 0.05 + 0.002 * i;
        expected += 0.5 * e * r * r / d2 * 3 / std::sqrt(d2);
    }
    expect_mean(render_film(b.scene, small_image_settings(16, 16), 256), expected, 0.01);
}

}  // namespace
}  // namespace fathom
