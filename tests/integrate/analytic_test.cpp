// SPDX-License-Identifier: Apache-2.0
#include "picture_helpers.h"

namespace fathom {
namespace {

using namespace test;

TEST(Furnace, EnclosureHasTheRadianceOfTheGeometricSeries)
{
    // Inside a sphere with emission 1 and albedo a, radiance is 1 / (1 - a) everywhere.
    for (bool light_sampling : {true, false})
        for (float albedo : {0.5f, 0.8f}) {
            SceneBuilder b;
            b.add(Sphere{{0, 0, 0}, -1, {}}, b.diffuse(albedo, {1, 1, 1}));
            b.camera({0.3, 0.1, 0.2}, {1, 0, 0}, 60);
            RenderSettings settings = small_image_settings();
            settings.light_sampling = light_sampling;
            expect_mean(render_film(b.scene, settings, 64), 1 / (1 - albedo));
        }
}

TEST(Furnace, ClosedRoomOfRectangles)
{
    SceneBuilder b;
    const int wall = b.diffuse(0.6f, {1, 1, 1}, true);
    b.add(Box{{-1, -1, -1}, {1, 1, 1}}, wall);
    b.camera({0.3, 0.1, 0.2}, {1, 0, 0}, 60);
    expect_mean(render_film(b.scene, small_image_settings(), 256), 2.5);
}

TEST(Furnace, EveryMaterialUnderAWhiteSky)
{
    // A convex lossless object is invisible in a constant environment.
    const auto expect = [](Material m, double value, double tolerance) {
        m.base_color.value = {1, 1, 1};
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, 1, {}}, b.material(m));
        b.scene.environment = uniform_sky();
        b.camera({0, 0, 2.2}, {0, 0, 0}, 30);
        expect_mean(render_film(b.scene, small_image_settings(), 64), value, tolerance);
    };
    Material m;
    for (float roughness : {0.0f, 0.5f, 1.0f}) {
        m.roughness.value = roughness;
        m.kind = MaterialKind::diffuse;
        expect(m, 1, 0.002);
        m.kind = MaterialKind::metal;
        expect(m, 1, 0.012);
        m.kind = MaterialKind::principled;
        m.metallic.value = 1;
        expect(m, 1, 0.015);
        m.metallic.value = 0;
    }
    m.kind = MaterialKind::glass;
    m.roughness.value = 0;
    expect(m, 1, 0.002);
    m.kind = MaterialKind::fuzz_metal;
    m.fuzz = 0;
    expect(m, 1, 0.002);
}

/// Russian roulette adds no noise without losses: each path through glass carries exactly the sky's radiance.
TEST(Furnace, LosslessPathsHaveNoVariance)
{
    for (const bool thin : {false, true}) {
        SceneBuilder b;
        Material glass;
        glass.kind = MaterialKind::glass;
        glass.interior.thin = thin;
        const int m = b.material(glass);
        if (thin)
            for (int i = 0; i < 4; ++i) b.add(Rectangle{{-50, -50, -2.0 - i}, {100, 0, 0}, {0, 100, 0}}, m);
        else
            for (int i = 0; i < 2; ++i) b.add(Sphere{{0, 0, -6.0 - 5 * i}, 2, {}}, m);
        b.scene.environment = uniform_sky();
        b.camera({0, 0, 0}, {0, 0, -1}, 30);
        const Mean mean = mean_of(render_film(b.scene, small_image_settings(), 64));
        EXPECT_NEAR(mean.value[0], 1, 1e-4);
        EXPECT_LT(mean.error[0], 1e-5);
    }
}

/// In a closed lossless room paths still end, after about 64 + 20 bounces. A black light of radiance 1 gives a radiance
/// of 1 everywhere.
TEST(Furnace, PathsEndInAClosedWhiteRoom)
{
    for (const bool lamp : {false, true}) {
        SceneBuilder b;
        b.add(Sphere{{0, 0, 0}, -1, {}}, b.diffuse(1));
        if (lamp) b.add(Sphere{{0, 0, 0}, 0.5, {}}, b.diffuse(0, {1, 1, 1}));
        b.camera({0.3, 0.6, 0.2}, {1, 0.6, 0}, 60);
        Warnings warnings;
        const Scene scene = Scene::compile(b.scene, "", warnings);
        const RenderSettings settings = small_image_settings();
        const RenderJob job(scene, settings);
        Film film(job);
        std::uint64_t rays = 0;
        render(job, {0, 64}, film, nullptr,
               [&](const Progress& progress, const Film&) { rays = progress.costs.all_rays(); });
        expect_mean(film, lamp ? 1 : 0, 0.001);
        const double rays_per_path = double(rays) / (64 * 32 * 24);
        if (lamp)
            EXPECT_LT(rays_per_path, 2 * (64 + 20));
        else
            EXPECT_NEAR(rays_per_path, 64 + 20, 2);
    }
}

TEST(Furnace, TheSameForATreeOfTriangles)
{
    // An octahedron subdivided into enough triangles to need the BVH.
    SceneBuilder b;
    constexpr std::uint32_t n = 16;
    const Mesh mesh = octahedron_mesh(n, [](Vec3d sign, std::uint32_t i, std::uint32_t j) {
        return Vec3f{float(sign.x) * float(i) / n, float(sign.y) * float(j) / n, float(sign.z) * float(n - i - j) / n};
    });
    b.scene.meshes.push_back(mesh);
    b.add(MeshInstance{0}, b.diffuse(1));
    b.scene.environment = uniform_sky();
    b.camera({1, 2, 3}, {0, 0, 0}, 20);
    expect_mean(render_film(b.scene, small_image_settings(), 32), 1);
}

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
    // Disk of radius r at height h, centered above: E = pi L r^2 / (r^2 + h^2).
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
    // A disk of directions so large that BSDF samples would often hit it if it were visible.
    light.angle = 1.2;
    expect_mean(mean(light, {0, 0, 0}), 0.5 / std::numbers::pi * 5);
    light.kind = LightKind::spot;
    light.inner_angle = 0.3;
    light.outer_angle = 0.6;
    expect_mean(mean(light, {0, 2, 0}), 0.5 / std::numbers::pi * 5 / 4);
    expect_mean(mean(light, {3, 2, 0}), 0, 0);
}

/// Spot light from the cone's center to beyond its edge, for tiny cones to more than a hemisphere: formula of
/// KHR_lights_punctual in double precision.
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
        // Foot of the perpendicular in the area's coordinates, by the normal equations of least squares.
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

/// Tubes of a radiance or a flux, near and far, turned and scaled, at rest and carried by a moving node.
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
                    b.scene.cameras[0].fov_y = 1e-3;
                    Light light;
                    light.kind = LightKind::tube;
                    light.length = 0.5, light.radius = 0.04;
                    light.intensity = {5, 5, 5};
                    light.intensity_is_flux = is_flux;
                    b.light(light, place);
                    if (moves) {
                        // A motion that ends where it began: the tube is at the same place at every time.
                        b.scene.cameras[0].shutter_close = 1;
                        b.scene.nodes.back().motion = {{0, place}, {1, place}};
                    }
                    const double side = 2 * std::numbers::pi * 0.04 * 0.5 * scale * scale;
                    const double radiance = is_flux ? 5 / (std::numbers::pi * side) : 5;
                    SCOPED_TRACE(std::to_string(scale) + " " + std::to_string(height) + (is_flux ? " lm" : "") +
                                 (moves ? " moves" : ""));
                    expect_mean(render_film(b.scene, small_image_settings(16, 16), 64),
                                0.5 / std::numbers::pi * radiance * tube_irradiance(place, 0.5, 0.04), 0.005);
                }
}

/// The tree selects tubes among other lights with the correct probability, and what is between blocks their light.
TEST(Lights, TubesBesideOthersAndShadowsOfTubes)
{
    const Transform place = Transform::translate({0.5, 1, 0.2}) * Transform::rotate({0, 1, 0}, 1);
    SceneBuilder b = floor_scene(0.5f, 0.06);
    b.scene.cameras[0].fov_y = 1e-3;
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
    dark.scene.cameras[0].fov_y = 1e-3;
    dark.scene.cameras[0].position = {0.3, 0.4, 0};
    dark.light(light, place);
    dark.add(Rectangle{{-9, 0.7, -9}, {18, 0, 0}, {0, 0, 18}}, dark.diffuse(0));
    expect_mean(render_film(dark.scene, small_image_settings(4, 4), 4), 0, 1e-6);
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

TEST(Alpha, OfEveryShape)
{
    const std::vector<decltype(Shape::geometry)> shapes = {Sphere{{0, 0, -5}, 2, {}}, Disk{{0, 0, -5}, {0, 0, 1}, 2},
                                                           Rectangle{{-2, -2, -5}, {4, 0, 0}, {0, 4, 0}},
                                                           Box{{-2, -2, -6}, {2, 2, -5}}};
    for (const auto& shape : shapes) {
        SceneBuilder b;
        Material m;
        m.kind = MaterialKind::none;
        m.emission.radiance.value = {1, 1, 1};
        m.opacity.mode = AlphaMode::blend;
        m.opacity.alpha.value = 0.25f;
        b.scene.nodes[0].shapes.push_back({shape, b.material(m), ""});
        b.camera({0, 0, 0}, {0, 0, -1}, 10);
        expect_mean(render_film(b.scene, small_image_settings(), 256), 0.25, 0.01);
    }
}

/// Each layer decides independently whether it stops a ray: n layers transmit (1 - alpha)^n, as separate shapes or as
/// instances of one mesh, also directly behind each other.
TEST(Alpha, OfAStackOfLayers)
{
    constexpr std::uint32_t n = 48;
    Mesh grid;  // large enough that copies become instances
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j)
            grid.positions.push_back({4 * float(i) / n - 2, 4 * float(j) / n - 2, 0});
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            grid.indices.insert(grid.indices.end(), {a, b, a + 1, a + 1, b, b + 1});
        }
    for (const bool copies : {false, true})
        for (const double distance : {0.5, 0.0})
            for (const float alpha : {0.2f, 0.5f}) {
                SceneBuilder b;
                Material m;
                m.kind = MaterialKind::none;
                m.opacity.mode = AlphaMode::blend;
                m.opacity.alpha.value = alpha;
                const int layer = b.material(m);
                b.scene.meshes.push_back(grid);
                for (int i = 0; i < 4; ++i) {
                    Node node;
                    node.parent_from_node = Transform::translate({0, 0, -5 - distance * i});
                    if (copies)
                        node.shapes.push_back({MeshInstance{0}, layer, ""});
                    else
                        node.shapes.push_back({Rectangle{{-2, -2, 0}, {4, 0, 0}, {0, 4, 0}}, layer, ""});
                    b.scene.roots.push_back(int(b.scene.nodes.size()));
                    b.scene.nodes.push_back(node);
                }
                b.scene.environment = uniform_sky();
                b.camera({0, 0, 0}, {0, 0, -1}, 10);
                b.scene.cameras[0].kind = CameraKind::orthographic;
                SCOPED_TRACE(std::to_string(copies) + " " + std::to_string(distance));
                expect_mean(render_film(b.scene, small_image_settings(), 64), std::pow(1 - alpha, 4), 0);
            }
}

/// A texture's alpha and its color match: black in front of white and white in front of black add up to white.
TEST(Alpha, OfEveryTexture)
{
    for (const TextureKind kind : {TextureKind::checker_uv, TextureKind::checker_space, TextureKind::noise,
                                   TextureKind::turbulence, TextureKind::marble}) {
        Texture texture;
        texture.kind = kind;
        texture.scale = 3;
        texture.color_a.value = {0.25f, 0, 0};
        double sum = 0, error2 = 0;
        for (const bool as_alpha : {false, true}) {
            SceneBuilder b;
            b.scene.textures.push_back(texture);
            Material m;
            m.kind = MaterialKind::none;
            if (as_alpha) {
                m.opacity.mode = AlphaMode::blend;
                m.opacity.alpha = {1, 0, 0};
                b.scene.environment = uniform_sky();
            } else {
                m.emission.radiance = {{1, 1, 1}, 0};
            }
            b.add(Rectangle{{-2, -2, -5}, {4, 0, 0}, {0, 4, 0}}, b.material(m));
            b.camera({0, 0, 0}, {0, 0, -1}, 30);
            const Mean mean = mean_of(render_film(b.scene, small_image_settings(), 256));
            EXPECT_GT(mean.value[0], 0.1);
            EXPECT_LT(mean.value[0], 0.9);
            sum += mean.value[0], error2 += mean.error[0] * mean.error[0];
        }
        EXPECT_NEAR(sum, 1, 4 * std::sqrt(error2)) << int(kind);
    }
}

/// A disk keeps its texture mapping when a transform turns it into an ellipse.
TEST(Textures, OfADistortedDisk)
{
    const auto mean = [](const Transform& transform) {
        SceneBuilder b;
        Texture checker;
        checker.kind = TextureKind::checker_uv;
        checker.scale = 2;
        b.scene.textures.push_back(checker);
        Material m;
        m.kind = MaterialKind::none;
        m.emission.radiance = {{1, 1, 1}, 0};
        Node node;
        node.parent_from_node = transform;
        node.shapes.push_back({Disk{{0, 0, 0}, {0.2, -0.4, 1}, 1}, b.material(m), ""});
        b.scene.roots.push_back(1);
        b.scene.nodes.push_back(node);
        b.camera({0.3, 0.1, 3}, {0.3, 0.1, 0}, 10);
        return mean_of(render_film(b.scene, small_image_settings(), 64)).value[0];
    };
    // The transform makes an ellipse, but so close to a circle that the image is unchanged.
    const double expected = mean({});
    EXPECT_GT(expected, 0.1);
    EXPECT_LT(expected, 0.9);
    EXPECT_NEAR(mean(Transform::scale({1.0002, 1, 1})), expected, 0.01);
}

/// Textures rotate with their node: the image equals that of a camera rotated the other way and, for mirroring nodes,
/// its mirror image, because cameras are not mirrored.
TEST(Textures, TurnWithTheNode)
{
    const Transform turn = Transform::rotate({0.3, 1, 0.5}, 1.1) * Transform::rotate({1, 0, 0}, 0.4);
    const Transform mirror = Transform::scale({-1.5, 1.5, 1.5});
    Points points;
    points.centers = {{0, 0, 0}};
    points.radii = {1};
    const std::vector<decltype(Shape::geometry)> shapes = {Sphere{{0, 0, 0}, 1, {}}, Disk{{0, 0, 0}, {0.2, 0.3, 1}, 1},
                                                           PointsInstance{0}};
    for (const auto& shape : shapes)
        for (const bool mirrors : {false, true}) {
            const Transform transform = mirrors ? turn * mirror : turn;
            Image pictures[2];
            for (const bool turns_camera : {false, true}) {
                SceneBuilder b;
                b.scene.points.push_back(points);
                Texture checker;
                checker.kind = TextureKind::checker_uv;
                checker.uv_scale = {4, 4};
                checker.color_b.value = {1, 0.5f, 0.25f};
                b.scene.textures.push_back(checker);
                Material m;
                m.kind = MaterialKind::none;
                m.emission.radiance = {{1, 1, 1}, 0};
                m.emission.two_sided = true;
                Node node;
                if (!turns_camera) node.parent_from_node = transform;
                node.shapes.push_back({shape, b.material(m), ""});
                b.scene.roots.push_back(1);
                b.scene.nodes.push_back(node);
                b.camera({0.3, 0.2, 4}, {0, 0, 0}, 50);
                if (turns_camera) b.scene.nodes[0].parent_from_node = transform.inverse();
                pictures[turns_camera] = render_film(b.scene, small_image_settings(), 64).image(false, false);
            }
            double difference = 0;
            for (int y = 0; y < 24; ++y)
                for (int x = 0; x < 32; ++x) {
                    const auto at = [&](int picture, int column) {
                        return double(pictures[picture].layers[0].pixels[std::size_t(3 * (y * 32 + column) + 1)]);
                    };
                    difference += std::abs(at(0, x) - at(1, mirrors ? 31 - x : x)) / (32 * 24);
                }
            EXPECT_LT(difference, 0.02) << shape.index() << " " << mirrors;
        }
}

TEST(Glass, AbsorbsByPathLength)
{
    // Slab at normal incidence: two transmissions, absorption, and the geometric series of internal reflections.
    SceneBuilder b;
    Material glass;
    glass.kind = MaterialKind::glass;
    glass.interior.attenuation_color = {0.5f, 0.5f, 0.5f};
    glass.interior.attenuation_distance = 2;
    b.add(Box{{-50, -50, -1}, {50, 50, 0}}, b.material(glass));
    b.scene.environment = uniform_sky();
    b.camera({0, 0, 1}, {0, 0, 0}, 0.5);
    const double r = 0.04, a = std::sqrt(0.5);
    expect_mean(render_film(b.scene, small_image_settings(16, 16), 1024),
                r + (1 - r) * (1 - r) * (a + a * a * r) / (1 - r * r * a * a), 0.005);
}

TEST(Camera, DepthNormalAndPositionOfAPlane)
{
    SceneBuilder b;
    b.add(Rectangle{{-50, -50, -3}, {100, 0, 0}, {0, 100, 0}}, b.diffuse(0.25f));
    b.camera({1, 2, 4}, {1, 2, 0}, 30);
    RenderSettings settings = small_image_settings();
    settings.aovs = {Aov::albedo, Aov::normal, Aov::depth, Aov::position, Aov::material_id};
    const Image image = render_film(b.scene, settings, 4).image(false, false);
    for (std::size_t i = 0; i < 32 * 24; ++i) {
        EXPECT_NEAR(image.find("depth")->pixels[i], 7, 1e-3);
        EXPECT_NEAR(image.find("normal")->pixels[3 * i + 2], 1, 1e-6);
        EXPECT_NEAR(image.find("albedo")->pixels[3 * i], 0.25, 1e-6);
        EXPECT_NEAR(image.find("position")->pixels[3 * i + 2], -3, 1e-3);
        EXPECT_EQ(image.find("material")->pixels[i], 0);
    }
    // The image's center looks along the axis; x grows to the right, y upwards.
    const auto& p = image.find("position")->pixels;
    EXPECT_LT(p[3 * (12 * 32 + 2)], p[3 * (12 * 32 + 29)]);
    EXPECT_GT(p[3 * (2 * 32 + 16) + 1], p[3 * (21 * 32 + 16) + 1]);
}

}  // namespace
}  // namespace fathom
