#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <set>

#include "compile/scene_data.h"
#include "compile/sky.h"
#include "fathom/error.h"

// What is compiled from descriptions, looked at in the tables themselves: most of it shows in a picture only as noise,
// or as a place where two mistakes cancel.
namespace fathom {
namespace {

SceneDescription empty_scene()
{
    SceneDescription d;
    d.file = "test";
    d.nodes.emplace_back();
    d.roots = {0};
    d.cameras.emplace_back();
    d.nodes[0].camera = 0;
    return d;
}
Scene compiled(const SceneDescription& d)
{
    Warnings warnings;
    return Scene::compile(d, "", warnings);
}
int add_lamp(SceneDescription& d, float radiance, bool two_sided = false)
{
    Material m;
    m.emission.value = {radiance, radiance, radiance};
    m.emission_two_sided = two_sided;
    d.materials.push_back(m);
    return int(d.materials.size()) - 1;
}
void add_light(SceneDescription& d, const Light& light, const Transform& place)
{
    Node node;
    node.parent_from_node = place;
    node.light = int(d.lights.size());
    d.lights.push_back(light);
    d.roots.push_back(int(d.nodes.size()));
    d.nodes.push_back(node);
}

/// Probabilities add up to 1, are those of the cumulative table, and go with power: area times radiance times pi, twice
/// for two sides, 4 pi times intensity; none has less than a hundredth of the mean.
TEST(LightTable, ProbabilitiesGoWithPower)
{
    SceneDescription d = empty_scene();
    const auto shape = [&](auto geometry, int material) { d.nodes[0].shapes.push_back({geometry, material, ""}); };
    const int one = add_lamp(d, 3), two = add_lamp(d, 3, true);
    shape(Rectangle{{0, 0, -9}, {2, 0, 0}, {0, 3, 0}}, one);
    shape(Rectangle{{9, 0, -9}, {2, 0, 0}, {0, 3, 0}}, two);
    shape(Sphere{{0, 9, -9}, 0.5, {}}, one);
    shape(Disk{{9, 9, -9}, {0, 0, 1}, 0.75}, one);
    shape(Rectangle{{0, -9, -9}, {1e-3, 0, 0}, {0, 1e-3, 0}}, one);
    Light point;
    point.intensity = {2, 2, 2};
    add_light(d, point, Transform::translate({1, 2, 3}));
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.lights.size(), 6u);
    ASSERT_EQ(t.light_cdf.size(), 7u);
    const double pi = std::numbers::pi;
    // By the order of the table: quads, spheres, disks, lights. The small one has a hundredth of the mean.
    std::vector<double> power = {3 * 6 * pi,           2 * 3 * 6 * pi, 0, 3 * 4 * pi * 0.25 * pi,
                                 3 * pi * 0.5625 * pi, 2 * 4 * pi};
    double total = 0;
    for (double p : power) total += p;
    power[2] = 0.01 * total / 6;
    total += power[2];
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_NEAR(t.lights[i].pmf, power[i] / total, 2e-5) << i;
        EXPECT_FLOAT_EQ(t.lights[i].pmf, t.light_cdf[i + 1] - t.light_cdf[i]);
    }
    EXPECT_EQ(t.light_cdf.front(), 0);
    EXPECT_NEAR(t.light_cdf.back(), 1, 1e-6);
    EXPECT_TRUE(t.lights[1].two_sided);
    EXPECT_FALSE(t.lights[0].two_sided);
}

/// Shapes know their lights, lights their primitives, in render space.
TEST(LightTable, LampsStandWhereTheirShapesDo)
{
    SceneDescription d = empty_scene();
    d.cameras[0].position = {1, 0, 0}, d.cameras[0].look_at = {1, 0, -1};
    const int lamp = add_lamp(d, 5);
    d.nodes[0].parent_from_node = Transform::translate({0, 0, -3}) * Transform::scale({2, 2, 2});
    d.nodes[0].camera = -1;
    d.nodes.emplace_back().camera = 0;
    d.roots.push_back(1);
    d.nodes[0].shapes = {{Rectangle{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}}, lamp, ""}, {Sphere{{4, 0, 0}, -1, {}}, lamp, ""}};
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    const double s = t.render_scale;
    ASSERT_EQ(t.lights.size(), 2u);
    const LightRecord& r = t.lights[0];
    EXPECT_EQ(r.kind, std::uint32_t(LightRecordKind::rectangle));
    EXPECT_FLOAT_EQ(r.position[0], float(-1 * s));
    EXPECT_FLOAT_EQ(r.position[2], float(-3 * s));
    EXPECT_FLOAT_EQ(r.length_u, float(2 * s));
    EXPECT_FLOAT_EQ(r.area, float(4 * s * s));
    EXPECT_FLOAT_EQ(r.normal[2], -1);  // y cross x
    EXPECT_FLOAT_EQ(r.motion_or_center[0], 0);
    EXPECT_FLOAT_EQ(r.motion_or_center[1], float(s));
    EXPECT_FLOAT_EQ(r.radius, float(std::sqrt(8.0) * s));
    EXPECT_EQ(r.radiance[0], 5);
    EXPECT_EQ(r.primitive, t.first_quad());
    const LightRecord& ball = t.lights[1];
    EXPECT_EQ(ball.kind, std::uint32_t(LightRecordKind::sphere));
    EXPECT_FLOAT_EQ(ball.position[0], float(7 * s));
    EXPECT_FLOAT_EQ(ball.radius, float(-2 * s));
    for (std::uint32_t i = 0; i < 2; ++i) {
        const ShapeRecord& shape = t.shapes[t.shape_of_primitive[t.lights[i].primitive]];
        EXPECT_EQ(shape.light_base + (t.lights[i].primitive - shape.first_primitive), i);
    }
}

/// The sun of a sky is a light of the size and the light that it has, where the sky says; turned with it, and gone at
/// night.
TEST(LightTable, TheSunOfASky)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -4}, 1, {}}, -1, ""});
    d.environment.kind = EnvironmentKind::sky;
    d.environment.to_sun = {2, 1, 0};
    d.environment.color = {3, 3, 3};
    for (const double turn_deg : {0., 90.}) {
        d.environment.world_from_environment = Transform::rotate({0, 1, 0}, turn_deg * std::numbers::pi / 180);
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        ASSERT_EQ(t.lights.size(), 2u);
        const LightRecord& sun = t.lights[1];
        EXPECT_EQ(LightRecordKind(sun.kind), LightRecordKind::directional);
        const double side = 2 / std::sqrt(5), up = 1 / std::sqrt(5);
        EXPECT_NEAR(sun.edge_u[0], turn_deg == 0 ? -side : 0, 1e-6);
        EXPECT_NEAR(sun.edge_u[1], -up, 1e-6);
        EXPECT_NEAR(sun.edge_u[2], turn_deg == 0 ? 0 : side, 1e-6);
        // A disk of 0.00935 radians gives its radiance times pi sin^2 of half of that.
        const double s = std::sin(0.00935 / 2), irradiance = double(sun.radiance[1]) * std::numbers::pi * s * s;
        EXPECT_NEAR(irradiance / (3 * double(Sky::sun_irradiance({2, 1, 0}).g)), 1, 1e-5);
        // And the sky is seen where it is: its middle column looks along its +x, which is the sun's side.
        const EnvironmentRecord& e = t.environment;
        const auto at = [&](int x, int y) { return double(e.texels[std::size_t(4 * (y * e.width + x) + 1)]); };
        EXPECT_GT(at(e.width / 2, e.height / 3), 1.5 * at(0, e.height / 3));
        const double theta = (10 + 0.5) / e.height * std::numbers::pi,
                     phi = (30.5 / e.width - 0.5) * 2 * std::numbers::pi;
        const Color seen = Sky({2, 1, 0}).radiance(
            {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)});
        EXPECT_NEAR(at(30, 10) / double(seen.g), 1, 1e-5);
    }
    for (const auto& [to_sun, disk] : {std::pair{Vec3d{2, -0.01, 0}, true}, {Vec3d{2, 1, 0}, false}}) {
        d.environment.to_sun = to_sun;
        d.environment.sun_disk = disk;
        EXPECT_EQ(compiled(d).data().tables->lights.size(), 1u);
    }
    d.environment.to_sun = {0, 0, 0};
    EXPECT_THROW(compiled(d), Error);
}

TEST(LightTable, PointSpotAndSun)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -40}, 10, {}}, -1, ""});
    Light light;
    light.intensity = {1, 2, 3};
    add_light(d, light, Transform::translate({0, 5, 0}));
    light.kind = LightKind::spot;
    light.inner_angle = 0.2, light.outer_angle = 0.5;
    add_light(d, light, Transform::rotate({1, 0, 0}, -std::numbers::pi / 2) * Transform::scale({3, 3, 3}));
    light.kind = LightKind::directional;
    add_light(d, light, Transform::translate({7, 7, 7}));
    light.angle = 0.5;
    add_light(d, light, {});
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.lights.size(), 4u);
    const double s = t.render_scale;
    EXPECT_NE(s, 1);
    for (std::size_t i : {0, 1})
        for (std::size_t c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(t.lights[i].radiance[c], float(double(c + 1) * s * s));
    EXPECT_FLOAT_EQ(t.lights[0].position[1], float(5 * s));
    EXPECT_NEAR(t.lights[1].edge_u[1], -1, 1e-6);  // -z turned downwards
    EXPECT_FLOAT_EQ(t.lights[1].outer, float(1 - std::cos(0.5)));
    EXPECT_FLOAT_EQ(t.lights[1].falloff, float(std::cos(0.2) - std::cos(0.5)));
    EXPECT_FLOAT_EQ(t.lights[2].radiance[2], 3);  // irradiance knows no scale
    EXPECT_EQ(t.lights[2].radius, 0);
    EXPECT_NEAR(t.lights[2].edge_u[2], -1, 1e-6);
    const double half = 0.25;
    EXPECT_NEAR(t.lights[3].radius, 1 - std::cos(half), 1e-7);
    EXPECT_NEAR(t.lights[3].radiance[1] * std::numbers::pi * std::sin(half) * std::sin(half), 2, 1e-5);
}

TEST(MaterialTable, KeepsWhatTheMaterialSays)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -40}, 10, {}}, 0, ""});
    Material m;
    m.kind = MaterialKind::glass;
    m.base_color.value = {0.1f, 0.1f, 0.1f};
    m.transmission_color.value = {0.2f, 0.3f, 0.4f};
    m.attenuation_color = {0.5f, 0.25f, 1};
    m.attenuation_distance = 2;
    m.ior = 1.7f;
    m.roughness = {0.3f, -1, 2};
    m.metallic = {0.4f, -1, 1};
    m.alpha = {0.6f, -1, 0};
    m.alpha_cutoff = 0.7f, m.alpha_mode = AlphaMode::mask;
    m.fuzz = 0.8f, m.normal_scale = 0.9f;
    d.materials = {m, m, m, m, m};
    d.materials[1].thin = true;
    d.materials[2].kind = MaterialKind::unlit;
    d.materials[3].kind = MaterialKind::principled;
    d.materials[4].kind = MaterialKind::fuzz_metal;
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.materials.size(), 6u);
    const MaterialRecord& r = t.materials[0];
    EXPECT_EQ(r.closure, ClosureKind::glass);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(r.base_color[c], 0.2f + 0.1f * float(c));
        // Of the way through so many metres, attenuation_color is left: by exp(-sigma t) in render units.
        const double left[] = {0.5, 0.25, 1};
        EXPECT_NEAR(std::exp(-double(t.media[r.medium].extinction[c]) * 2 * t.render_scale), left[c], 1e-6);
        EXPECT_EQ(t.materials[2].emission[c], 0.1f);
    }
    EXPECT_EQ(r.ior, 1.7f);
    EXPECT_EQ(t.media[r.medium].ior, 1.7f);
    // A sheet encloses the same, of index 1; of what is no glass there is no inside; the first medium is empty space.
    const MediumRecord& enclosed = t.media[t.materials[1].medium];
    EXPECT_EQ(enclosed.ior, 1);
    EXPECT_EQ(enclosed.extinction, t.media[r.medium].extinction);
    EXPECT_TRUE(enclosed.is_open && !t.media[r.medium].is_open);
    EXPECT_EQ(t.materials[2].medium, 0u);
    EXPECT_EQ(t.media.size(), 3u);
    EXPECT_EQ(t.media[0].ior, 1);
    EXPECT_EQ(r.roughness, 0.3f);
    EXPECT_EQ(r.roughness_channel, 2u);
    EXPECT_EQ(t.materials[3].metallic, 0.4f);
    EXPECT_EQ(t.materials[3].metallic_channel, 1u);
    // Glass has no such parameter: whatever it says does not count.
    EXPECT_EQ(r.metallic, Material().metallic.value);
    EXPECT_EQ(r.alpha, 0.6f);
    EXPECT_EQ(r.alpha_channel, 0u);
    EXPECT_EQ(r.alpha_cutoff, 0.7f);
    EXPECT_EQ(r.alpha_mode, std::uint32_t(AlphaMode::mask));
    EXPECT_EQ(t.materials[4].fuzz, 0.8f);
    EXPECT_EQ(r.normal_scale, 0.9f);
    EXPECT_FALSE(r.flags & (MaterialRecord::thin | MaterialRecord::sheet));
    EXPECT_TRUE(t.materials[1].flags & MaterialRecord::thin);
    EXPECT_TRUE(t.materials[1].flags & MaterialRecord::sheet);
    EXPECT_TRUE(t.materials[2].flags & MaterialRecord::unlit);
    EXPECT_EQ(t.materials[2].closure, ClosureKind::none);
    EXPECT_TRUE(t.lights.empty());
}

/// A principled material becomes the simplest closure that does what it asks for.
TEST(MaterialTable, LayersAsNeeded)
{
    using enum ClosureKind;
    const auto closure = [](const std::function<void(Material&)>& change) {
        SceneDescription d = empty_scene();
        Material m;
        m.kind = MaterialKind::principled;
        change(m);
        d.materials = {m};
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        EXPECT_EQ(t.layers.size(), t.materials[0].closure == layered || t.materials[0].closure == layered_transmitting);
        return t.materials[0].closure;
    };
    EXPECT_EQ(closure([](Material&) {}), principled);
    EXPECT_EQ(closure([](Material& m) { m.metallic.value = 1; }), principled);
    EXPECT_EQ(closure([](Material& m) { m.transmission.value = 1; }), glass);
    EXPECT_EQ(closure([](Material& m) { m.transmission.value = 1, m.thin = true; }), glass);
    EXPECT_EQ(closure([](Material& m) { m.transmission.value = 1, m.metallic.value = 0.5f; }), layered_transmitting);
    EXPECT_EQ(closure([](Material& m) { m.transmission.value = 0.5f; }), layered_transmitting);
    EXPECT_EQ(closure([](Material& m) { m.transmission.value = 1, m.dispersion = 1; }), layered_transmitting);
    EXPECT_EQ(closure([](Material& m) { m.transmission.value = 1, m.coat.value = 1; }), layered_transmitting);
    EXPECT_EQ(closure([](Material& m) { m.diffuse_transmission.value = 0.5f; }), layered_transmitting);
    const std::function<void(Material&)> changes[] = {
        [](Material& m) { m.coat.value = 0.1f; },           [](Material& m) { m.sheen_color.value = {0, 0.1f, 0}; },
        [](Material& m) { m.thin_film.value = 0.1f; },      [](Material& m) { m.anisotropy.value = 0.1f; },
        [](Material& m) { m.diffuse_roughness.value = 1; }, [](Material& m) { m.specular.value = 0.5f; },
        [](Material& m) { m.specular_color.value.g = 0; },  [](Material& m) { m.edge_color.value.g = 0; }};
    for (const auto& change : changes) EXPECT_EQ(closure(change), layered);
}

TEST(MaterialTable, DisneysPassLightWhereAsked)
{
    const auto closure = [](const std::function<void(Material&)>& change) {
        SceneDescription d = empty_scene();
        Material m;
        m.kind = MaterialKind::disney;
        change(m);
        d.materials = {m};
        return compiled(d).data().tables->materials[0];
    };
    using enum ClosureKind;
    EXPECT_EQ(closure([](Material&) {}).closure, disney);
    EXPECT_EQ(closure([](Material& m) { m.diffuse_transmission.value = 1; }).closure, disney);
    EXPECT_EQ(closure([](Material& m) { m.diffuse_transmission.value = 1, m.thin = true; }).closure,
              disney_transmitting);
    EXPECT_NE(closure([](Material& m) { m.transmission.value = 1; }).medium, 0u);
    EXPECT_EQ(closure([](Material& m) { m.transmission.value = 1, m.thin = true; }).medium, 0u);
}

/// The share that a layer under a boundary of index 1.5 takes from what that throws back, integrated elsewhere.
TEST(PlasticTable, LayersLoseAShareWithin)
{
    for (const auto& [thickness, lost] : {std::pair{0.0f, 0.0f}, {0.01f, 0.048598f}, {0.2f, 0.566788f}}) {
        SceneDescription d = empty_scene();
        Material m;
        m.kind = MaterialKind::plastic;
        m.optical_thickness = thickness;
        d.materials = {m};
        const Scene scene = compiled(d);
        const MaterialRecord& record = scene.data().tables->materials[0];
        EXPECT_EQ(record.fuzz, thickness);
        EXPECT_NEAR(record.metallic, lost, 2e-5);
    }
}

/// What principled is told of its losses and its boundary reaches the simpler closures.
TEST(MaterialTable, CompensationAndOneBoundary)
{
    for (const bool compensated : {false, true}) {
        SceneDescription d = empty_scene();
        Material m;
        m.kind = MaterialKind::principled;
        m.energy_compensation = compensated;
        m.transmission.value = 1, m.thin = true;
        d.materials = {m};
        d.nodes[0].shapes.push_back({Sphere{{0, 0, 0}, 1, {}}, 0, ""});
        const Scene scene = compiled(d);
        const MaterialRecord& r = scene.data().tables->materials[0];
        EXPECT_EQ(r.closure, ClosureKind::glass);
        EXPECT_EQ((r.flags & MaterialRecord::compensated) != 0, compensated);
        EXPECT_TRUE(r.flags & MaterialRecord::thin);
        EXPECT_FALSE(r.flags & MaterialRecord::sheet);
    }
}

/// The camera as the kernel has it: right, up and forward are a right-handed frame, lengths are in render units.
TEST(CameraTable, FrameSizeAndLens)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Sphere{{100, 0, 0}, 1, {}}, -1, ""});
    Camera& c = d.cameras[0];
    c.position = {1, 2, 3}, c.look_at = {11, 2, 3}, c.up = {1, 1, 0};
    c.fov_y = 1, c.aperture = 0.5, c.focus_distance = 4;
    c.shutter_open = 0.25, c.shutter_close = 0.75;
    const Scene scene = compiled(d);
    const double s = scene.data().tables->render_scale;
    CameraRecord r = scene.data().camera_record(scene.camera(), 30, 20);
    const auto expect = [](const float(&got)[3], Vec3d e) {
        EXPECT_NEAR(got[0], e.x, 1e-5);
        EXPECT_NEAR(got[1], e.y, 1e-5);
        EXPECT_NEAR(got[2], e.z, 1e-5);
    };
    expect(r.position, {0, 0, 0});
    expect(r.forward, {1, 0, 0});
    expect(r.up, {0, 1, 0});
    expect(r.right, {0, 0, 1});
    EXPECT_FLOAT_EQ(r.half_height, float(std::tan(0.5)));
    EXPECT_FLOAT_EQ(r.half_width, float(1.5 * std::tan(0.5)));
    EXPECT_FLOAT_EQ(r.lens_radius, float(0.25 * s));
    EXPECT_FLOAT_EQ(r.focus_distance, float(4 * s));
    EXPECT_EQ(r.shutter_open, 0.25f);
    EXPECT_EQ(r.shutter_close, 0.75f);
    EXPECT_EQ(r.shift_right, 0);
    Camera moved = scene.camera();
    moved.shift_x = 0.25, moved.shift_y = -2;
    r = scene.data().camera_record(moved, 30, 20);
    EXPECT_FLOAT_EQ(r.shift_right, float(0.5 * 1.5 * std::tan(0.5)));
    EXPECT_FLOAT_EQ(r.shift_up, float(-4 * std::tan(0.5)));
    moved.shift_x = moved.shift_y = 0;
    moved.position = {1, 2, 8}, moved.look_at = {11, 2, 8};
    moved.focus_distance = 0;
    r = scene.data().camera_record(moved, 30, 20);
    expect(r.position, {0, 0, 5 * s});
    EXPECT_FLOAT_EQ(r.focus_distance, float(10 * s));
    moved.kind = CameraKind::orthographic, moved.height = 7;
    r = scene.data().camera_record(moved, 30, 20);
    EXPECT_EQ(r.orthographic, 1u);
    EXPECT_FLOAT_EQ(r.half_height, float(3.5 * s));
    EXPECT_FLOAT_EQ(r.half_width, float(5.25 * s));
}

/// Render space: a power of two that brings the scene's radius to 512 to 1024, about the camera.
TEST(RenderSpace, BringsTheSceneToOneSize)
{
    for (double size : {1e-4, 1.0, 3.0, 777.0, 1e6}) {
        SceneDescription d = empty_scene();
        d.cameras[0].position = {size, size, 0}, d.cameras[0].look_at = {0, 0, 0};
        d.nodes[0].shapes.push_back({Box{{-size, -size, -size}, {size, size, size}}, -1, ""});
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        EXPECT_EQ(std::exp2(std::round(std::log2(t.render_scale))), t.render_scale);
        const double radius = 3 * size * t.render_scale;  // to the farthest corner
        EXPECT_GE(radius, 512) << size;
        EXPECT_LT(radius, 1024) << size;
        EXPECT_EQ(t.origin.x, size);
    }
}

/// Six faces with their normals outwards; the sphere that a transform distorts is a mesh that lies on the ellipsoid.
TEST(GeometryTable, BoxesAndDistortedSpheres)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Box{{-1, -2, -3}, {1, 2, 3}}, -1, ""});
    Node node;
    node.parent_from_node = Transform::scale({3, 1, 1});
    node.shapes.push_back({Sphere{{0, 0, 0}, 2, {}}, -1, ""});
    node.shapes.push_back({Sphere{{0, 0, 0}, -2, {}}, -1, ""});
    d.nodes.push_back(node);
    d.roots.push_back(1);
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    const auto world = [&](Vec3f p) { return Vec3d{p.x, p.y, p.z} * (1 / t.render_scale) + t.origin; };
    const auto direction = [&](Vec3f p) { return Vec3d{p.x, p.y, p.z}; };
    ASSERT_EQ(t.quads.size(), 6u);
    for (const QuadRecord& q : t.quads) {
        const Vec3d middle = world(q.corner) + (direction(q.edge_u) + direction(q.edge_v)) * (0.5 / t.render_scale);
        const Vec3d n = normalize(cross(direction(q.edge_u), direction(q.edge_v)));
        const double distance = std::abs(middle.x) + std::abs(middle.y) + std::abs(middle.z);
        EXPECT_NEAR(dot(n, middle), distance, 1e-5);
        EXPECT_NEAR(std::abs(n.x) * 1 + std::abs(n.y) * 2 + std::abs(n.z) * 3, distance, 1e-5);
    }
    ASSERT_GT(t.positions.size(), 1000u);
    for (std::size_t i = 0; i < t.triangles.size(); i += 3) {
        const bool inwards = t.shape_of_primitive[i / 3] == t.shape_of_primitive[t.triangle_count() - 1];
        const auto at = [&](std::size_t k) { return world(t.positions[t.triangles[i + k]]); };
        const Vec3d n = cross(at(1) - at(0), at(2) - at(0));
        ASSERT_EQ(dot(n, at(0)) < 0, inwards) << i;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d p = at(k);
            ASSERT_NEAR(p.x * p.x / 36 + p.y * p.y / 4 + p.z * p.z / 4, 1, 1e-5);
            // The gradient of that.
            const Vec3d gradient = normalize(Vec3d{p.x / 36, p.y / 4, p.z / 4}) * (inwards ? -1.0 : 1.0);
            ASSERT_NEAR(dot(direction(t.normals[t.triangles[i + k]]), gradient), 1, 1e-5);
            const Vec2f uv = t.uv0[t.triangles[i + k]];
            ASSERT_NEAR(std::cos(double(uv.y) * std::numbers::pi), p.y / 2, 1e-5);
        }
    }
}

/// Under a transform that turns, stretches and mirrors, normals stay perpendicular to their faces and tangents in them.
TEST(GeometryTable, NormalsStayPerpendicular)
{
    for (const double mirror : {1.0, -1.0}) {
        SceneDescription d = empty_scene();
        Mesh mesh;
        mesh.positions = {{0, 1, 0}, {1, 1, 0}, {0, 0, 1}};
        const float h = float(std::sqrt(0.5));
        mesh.normals.assign(3, {0, h, h});
        mesh.tangents.assign(3, {1, 0, 0, 1});
        mesh.indices = {0, 2, 1};
        d.meshes = {mesh};
        Node node;
        node.parent_from_node = Transform::translate({0, 0, -9}) * Transform::rotate({1, 2, 3}, 1.1) *
                                Transform::scale({mirror * 2, 0.5, 3}) * Transform::rotate({0, 1, 1}, 0.4);
        node.shapes.push_back({MeshInstance{0}, -1, ""});
        node.shapes.push_back({Rectangle{{5, 0, 0}, {1, 0, 0}, {0, 1, 0}}, -1, ""});
        d.nodes.push_back(node);
        d.roots.push_back(1);
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        ASSERT_EQ(t.triangle_count(), 1u);
        const auto at = [&](std::size_t k) {
            const Vec3f p = t.positions[t.triangles[k]];
            return Vec3d{p.x, p.y, p.z};
        };
        const Vec3d face = normalize(cross(at(1) - at(0), at(2) - at(0)));
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f n = t.normals[t.triangles[k]];
            EXPECT_NEAR(dot(face, {n.x, n.y, n.z}), mirror, 1e-4);
            const Vec4f tangent = t.tangents[t.triangles[k]];
            const Vec3d along = normalize(node.parent_from_node.vector({1, 0, 0}));
            EXPECT_NEAR(dot(along, {tangent.x, tangent.y, tangent.z}), 1, 1e-5);
            EXPECT_EQ(tangent.w, mirror);
        }
    }
}

/// Where shapes that move are, and that a mesh placed often is there once, with maps to its own space.
TEST(GeometryTable, InstancesMapBack)
{
    SceneDescription d = empty_scene();
    Mesh mesh;
    constexpr std::uint32_t n = 40;
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j) mesh.positions.push_back({float(i) / n, float(j) / n, 0});
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, b, b + 1, a + 1});
        }
    d.meshes.push_back(mesh);
    std::vector<Transform> places;
    for (int i = 0; i < 3; ++i) {
        Node node;
        node.parent_from_node = Transform::translate({3.0 * i, 1, -2}) * Transform::rotate({1, 2, 3}, i) *
                                Transform::scale({1, i == 1 ? -1.0 : 1.0, 2});
        places.push_back(node.parent_from_node);
        node.shapes.push_back({MeshInstance{0}, -1, ""});
        d.roots.push_back(int(d.nodes.size()));
        d.nodes.push_back(node);
    }
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    EXPECT_EQ(t.triangle_count(), n * n * 2);
    ASSERT_EQ(t.instances.size(), 3u);
    std::set<std::uint32_t> ids;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& m = t.instances[i].object_from_render;
        const Vec3d p = (places[i].point({0.3, 0.7, 0.2}) - t.origin) * t.render_scale;
        const double expected[] = {0.3, 0.7, 0.2};
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(
                double(m[4 * k]) * p.x + double(m[4 * k + 1]) * p.y + double(m[4 * k + 2]) * p.z + double(m[4 * k + 3]),
                expected[k], 1e-5);
        ids.insert(t.instances[i].object_id);
    }
    EXPECT_EQ(ids.size(), 3u);
}

/// Neighbouring poses turn the shorter way, by the angle between them.
TEST(GeometryTable, PosesOfWhatTurns)
{
    SceneDescription d = empty_scene();
    d.cameras[0].shutter_open = 1, d.cameras[0].shutter_close = 2;
    Node node;
    for (int k = 0; k < 4; ++k)
        node.motion.push_back(
            {1 + k / 3.0, Transform::translate({double(k), 0, -5}) * Transform::rotate({0, 0, 1}, 2.5 * k)});
    node.shapes.push_back({Box{{-1, -1, -1}, {1, 1, 1}}, -1, ""});
    d.nodes.push_back(node);
    d.roots.push_back(1);
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    EXPECT_TRUE(t.moving);
    ASSERT_EQ(t.instances.size(), 1u);
    ASSERT_GE(t.instances[0].pose_count(), 4u);
    EXPECT_EQ(t.poses.front().time, 1);
    EXPECT_EQ(t.poses.back().time, 2);
    for (std::size_t k = 0; k + 1 < t.poses.size(); ++k) {
        const PoseRecord &a = t.poses[k], &b = t.poses[k + 1];
        double cosine = 0;
        for (int i = 0; i < 4; ++i) cosine += double(a.rotation[i]) * double(b.rotation[i]);
        EXPECT_GE(cosine, 0);
        const double angle = std::acos(std::min(1.0, cosine));
        EXPECT_NEAR(double(a.turns) * 2 * std::numbers::pi, angle, 1e-4);
        EXPECT_NEAR(double(a.inverse_sine) * std::sin(angle), 1, 1e-3);
        EXPECT_LT(a.time, b.time);
    }
}

/// Pairs of triangles that make a parallelogram become one, others stay; what needs its vertices is left alone.
TEST(GeometryTable, TrianglesAreJoinedWhereTheyMakeParallelograms)
{
    SceneDescription d = empty_scene();
    Mesh mesh;
    mesh.positions = {{0, 0, -5}, {2, 0, -5}, {3, 1, -5}, {1, 1, -5}, {9, 9, -5}};
    mesh.indices = {0, 1, 2, 0, 2, 3, 1, 4, 2};
    d.meshes = {mesh};
    d.nodes[0].shapes.push_back({MeshInstance{0}, -1, ""});
    const Scene joined = compiled(d);
    EXPECT_EQ(joined.data().tables->quads.size(), 1u);
    EXPECT_EQ(joined.data().tables->triangle_count(), 1u);
    const QuadRecord& q = joined.data().tables->quads[0];
    EXPECT_GT(q.edge_u.x * q.edge_v.y - q.edge_u.y * q.edge_v.x, 0);  // its front is still the front
}

/// Normals matter but where they are those of the planes: files have them for boxes, too.
TEST(GeometryTable, TrianglesAreJoinedWhereTheirNormalsSayNothing)
{
    const auto joined = [](std::vector<Vec3f> normals) {
        SceneDescription d = empty_scene();
        Mesh mesh;
        mesh.positions = {{0, 0, -5}, {2, 0, -5}, {3, 1, -5}, {1, 1, -5}};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        mesh.normals = std::move(normals);
        d.meshes = {mesh};
        d.nodes[0].shapes.push_back({MeshInstance{0}, -1, ""});
        const Scene scene = compiled(d);
        EXPECT_EQ(scene.data().tables->triangle_count() + 2 * scene.data().tables->quads.size(), 2u);
        return scene.data().tables->quads.size() == 1;
    };
    const Vec3f front{0, 0, 1}, back{0, 0, -1}, bent{0, 0.01f, 1}, rounded{0, 1e-6f, 1};
    EXPECT_TRUE(joined({front, front, front, front}));
    EXPECT_TRUE(joined({front, rounded, front, front}));
    EXPECT_FALSE(joined({front, front, front, bent}));
    EXPECT_FALSE(joined({back, back, back, back}));
}

/// Triangles that show where on them something is keep their texture coordinates.
TEST(GeometryTable, TrianglesThatShowTheirUvAreNotJoined)
{
    const auto quads = [](const std::function<void(Material&)>& change, bool mixed = false) {
        SceneDescription d = empty_scene();
        Mesh mesh;
        mesh.positions = {{0, 0, -5}, {2, 0, -5}, {3, 1, -5}, {1, 1, -5}};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        d.meshes = {mesh};
        Texture checks;
        checks.kind = TextureKind::checker_uv;
        d.textures = {checks};
        Material m, mix;
        m.kind = MaterialKind::principled;
        change(m);
        mix.kind = MaterialKind::mix, mix.material_a = mix.material_b = 0;
        d.materials = {m, mix};
        d.nodes[0].shapes.push_back({MeshInstance{0}, mixed ? 1 : 0, ""});
        return compiled(d).data().tables->quads.size();
    };
    EXPECT_EQ(quads([](Material& m) { m.coat.value = 1; }), 1u);
    EXPECT_EQ(quads([](Material& m) { m.kind = MaterialKind::disney; }), 1u);
    const std::function<void(Material&)> changes[] = {
        [](Material& m) { m.base_color.texture = 0; },
        [](Material& m) { m.coat.value = 1, m.coat.texture = 0; },
        [](Material& m) { m.sheen_color = {{1, 1, 1}, 0}; },
        [](Material& m) { m.anisotropy.value = 0.5f; },
        [](Material& m) { m.coat.value = 1, m.coat_normal_texture = 0; },
        [](Material& m) { m.emission = {{1, 1, 1}, 0}; },
        [](Material& m) { m.kind = MaterialKind::disney, m.flatness.texture = 0; },
        [](Material& m) { m.kind = MaterialKind::disney, m.anisotropy.value = 0.5f; },
        [](Material& m) { m.kind = MaterialKind::hair; }};
    for (const auto& change : changes)
        for (const bool mixed : {false, true}) EXPECT_EQ(quads(change, mixed), 0u);
}

/// Bezier points of each basis, shared between neighbours, and where along the curve each segment is.
TEST(GeometryTable, CurvesBecomeBezierSegments)
{
    for (const CurveBasis basis :
         {CurveBasis::linear, CurveBasis::bezier, CurveBasis::bspline, CurveBasis::catmull_rom}) {
        SceneDescription d = empty_scene();
        Curves curves;
        curves.basis = basis;
        for (int i = 0; i < 7; ++i) {
            curves.points.push_back({float(i * i % 5), float(i), -9 + float(i % 3)});
            curves.radii.push_back(0.1f * float(i + 1));
        }
        curves.counts = {7};
        d.curves = {curves};
        d.nodes[0].shapes.push_back({CurvesInstance{0}, -1, ""});
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        const std::size_t segments = basis == CurveBasis::linear ? 6 : basis == CurveBasis::bezier ? 2 : 4;
        ASSERT_EQ(t.curves.size(), segments);
        EXPECT_EQ(t.curves.front().u0, 0);
        EXPECT_EQ(t.curves.back().u1, 1);
        // At t of a segment, by the basis' own weights and by those of Bezier points.
        const auto weights = [](CurveBasis of, double x, double(&w)[4]) {
            const double s = 1 - x;
            if (of == CurveBasis::bezier)
                w[0] = s * s * s, w[1] = 3 * s * s * x, w[2] = 3 * s * x * x, w[3] = x * x * x;
            else if (of == CurveBasis::bspline)
                w[0] = s * s * s / 6, w[1] = (3 * x * x * x - 6 * x * x + 4) / 6,
                w[2] = (3 * s * s * s - 6 * s * s + 4) / 6, w[3] = x * x * x / 6;
            else if (of == CurveBasis::catmull_rom)
                w[0] = (-x + 2 * x * x - x * x * x) / 2, w[1] = (2 - 5 * x * x + 3 * x * x * x) / 2,
                w[2] = (x + 4 * x * x - 3 * x * x * x) / 2, w[3] = (x * x * x - x * x) / 2;
            else
                w[0] = s, w[1] = x, w[2] = w[3] = 0;
        };
        const std::size_t step = basis == CurveBasis::bezier ? 3 : 1;
        for (std::size_t i = 0; i < segments; ++i) {
            EXPECT_FLOAT_EQ(t.curves[i].u0, float(i) / float(segments));
            for (double x : {0.0, 0.3, 1.0}) {
                double w[4], b[4], expected[4] = {}, got[4] = {};
                weights(basis, x, w);
                weights(basis == CurveBasis::linear ? basis : CurveBasis::bezier, x, b);
                for (std::size_t k = 0; k < (basis == CurveBasis::linear ? 2u : 4u); ++k) {
                    const Vec3f p = curves.points[i * step + k];
                    const double from[] = {p.x, p.y, p.z, curves.radii[i * step + k]};
                    const Vec4f q = t.curve_points[t.curves[i].first_point + k];
                    const double to[] = {q.x, q.y, q.z, q.w};
                    for (std::size_t c = 0; c < 4; ++c) expected[c] += w[k] * from[c], got[c] += b[k] * to[c];
                }
                for (std::size_t c = 0; c < 4; ++c)
                    EXPECT_NEAR(got[c] / t.render_scale, expected[c], 1e-5) << int(basis) << i;
            }
        }
    }
}

/// Points that move are given at the times of all keys while the shutter is open: of each curve where it is then, cut
/// as finely as it is ever asked for.
TEST(GeometryTable, CurvesThatMoveHavePointsAtEachTime)
{
    SceneDescription d = empty_scene();
    Curves curves;
    curves.basis = CurveBasis::catmull_rom;
    for (int i = 0; i < 10; ++i) {
        curves.points.push_back({float(i % 5), 0, -9});
        curves.radii.push_back(0.1f);
    }
    curves.counts = {5, 5};
    curves.motion = {{0, curves.points, curves.radii}, {0.5, curves.points, curves.radii}};
    for (int i = 0; i < 10; ++i) curves.motion[1].points[std::size_t(i)].y += float(i * i % 7);
    d.curves = {curves};
    curves.motion[1].time = 0.75;
    d.curves.push_back(curves);
    for (int i = 0; i < 2; ++i) d.nodes[0].shapes.push_back({CurvesInstance{i}, -1, ""});
    d.cameras[0].shutter_close = 1;
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    EXPECT_EQ(t.vertex_times, (std::vector<float>{0, 0.5f, 0.75f, 1}));
    ASSERT_EQ(t.curves.size(), 8u);
    EXPECT_TRUE(t.moving);
    for (std::size_t k = 0; k < 8; ++k) {
        const std::uint32_t n = t.shapes[t.shape_of_primitive[t.first_curve() + k]].moving_vertices;
        EXPECT_EQ(n, 14u);
        EXPECT_GT(t.curves[k].pieces, 1u);
        // The first Bezier point of a segment is its second control point.
        const std::size_t point = 5 * (k % 4 / 2) + k % 2 + 1;
        const double end = k < 4 ? 0.5 : 0.75, way = double(point * point % 7);
        for (std::size_t time = 0; time < 4; ++time)
            EXPECT_FLOAT_EQ(float(t.curve_points[t.curves[k].first_point + time * n].y / t.render_scale),
                            float(way * std::min(1.0, double(t.vertex_times[time]) / end)))
                << k << ' ' << time;
    }
    // What stands still while the shutter is open stands where it then is.
    d.cameras[0].shutter_open = 1;
    const Scene later = compiled(d);
    const SceneTables& still = *later.data().tables;
    EXPECT_TRUE(still.vertex_times.empty());
    EXPECT_FALSE(still.moving);
    EXPECT_EQ(still.curve_points.size(), 2 * 14u);
    EXPECT_FLOAT_EQ(float(still.curve_points[0].y / still.render_scale), 1);
}

/// The light tree's ball around a curve holds it all along the way of its points, with its radius.
TEST(LightTable, BallsHoldCurvesThatMove)
{
    SceneDescription d = empty_scene();
    Curves curves;
    curves.basis = CurveBasis::linear;
    curves.points = {{9, 9, 9}, {9, 9, 8}};
    curves.radii = {1, 1};
    curves.counts = {2};
    curves.motion = {{0, {{0, 0, -9}, {1, 0, -9}}, {0.1f, 0.2f}},
                     {0.5, {{2, 0, -9}, {2, 3, -9}}, {0.1f, 0.5f}},
                     {1, {{-1, 0, -9}, {-3, 0, -9}}, {0.3f, 0}}};
    d.curves = {curves};
    d.nodes[0].shapes.push_back({CurvesInstance{0}, add_lamp(d, 3), ""});
    d.cameras[0].shutter_close = 1;
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.lights.size(), 1u);
    const LightNode& n = t.light_tree[t.lights[0].tree_place / LightNode::width];
    const std::size_t slot = t.lights[0].tree_place % LightNode::width;
    for (int i = 0; i <= 20; ++i)
        for (std::size_t end = 0; end < 2; ++end) {
            const CurvesKey &a = curves.motion[i < 10 ? 0 : 1], &b = curves.motion[i < 10 ? 1 : 2];
            const double f = i / 10.0 - (i < 10 ? 0 : 1);
            const auto mean = [&](float x, float y) {
                return t.render_scale * (double(x) + f * (double(y) - double(x)));
            };
            const Vec3f p = a.points[end], q = b.points[end];
            const double away = std::hypot(mean(p.x, q.x) - double(n.x[slot]), mean(p.y, q.y) - double(n.y[slot]),
                                           mean(p.z, q.z) - double(n.z[slot]));
            EXPECT_LE(away + mean(a.radii[end], b.radii[end]), double(n.radius[slot]) * (1 + 1e-6)) << i;
        }
    // Nor is it much larger.
    EXPECT_LT(double(n.radius[slot]), 6 * t.render_scale);
}

/// Rows and columns of a sky by their light: where there is none next to nothing is looked for.
TEST(EnvironmentTable, DistributionFollowsTheImage)
{
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "fathom-compile-sky.exr";
    Image image;
    image.width = 16, image.height = 8;
    image.layers.push_back({"", {"R", "G", "B"}, std::vector<float>(16 * 8 * 3, 0)});
    image.layers[0].pixels[3 * (2 * 16 + 0) + 1] = 9;  // column 0, row 2
    write_image(file, image, {});
    SceneDescription d = empty_scene();
    d.images.push_back({"sky", file, {}});
    d.environment.kind = EnvironmentKind::image;
    d.environment.image = 0;
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -40}, 10, {}}, -1, ""});
    const Scene scene = compiled(d);
    std::filesystem::remove(file);
    const EnvironmentRecord& e = scene.data().tables->environment;
    ASSERT_EQ(e.marginal.size(), 9u);
    ASSERT_EQ(e.conditional.size(), 8u * 17);
    // The mean over 3 x 3, times the sine of the row: rows 1, 2, 3, columns 15, 0, 1.
    double rows[8] = {}, total = 0;
    for (int y : {1, 2, 3}) rows[y] = std::sin((y + 0.5) * std::numbers::pi / 8), total += rows[y];
    for (std::size_t y = 0; y < 8; ++y) EXPECT_NEAR(e.marginal[y + 1] - e.marginal[y], rows[y] / total, 1e-6) << y;
    for (std::size_t y : {1u, 2u, 3u})
        for (std::size_t x = 0; x < 16; ++x)
            EXPECT_NEAR(e.conditional[y * 17 + x + 1] - e.conditional[y * 17 + x], x < 2 || x == 15 ? 1.0 / 3 : 0, 1e-6)
                << x;
    ASSERT_NE(e.light, no_index);
    EXPECT_EQ(scene.data().tables->lights[e.light].kind, std::uint32_t(LightRecordKind::environment));
}

/// Each thing that changes a picture changes the fingerprint, so that no films of two scenes are merged.
TEST(Fingerprint, TellsScenesApart)
{
    SceneDescription d = empty_scene();
    d.textures.emplace_back();
    d.textures[0].kind = TextureKind::noise;
    d.materials.emplace_back();
    d.meshes.emplace_back();
    d.meshes[0].positions = {{0, 0, -5}, {1, 0, -5}, {0, 1, -5}};
    d.meshes[0].normals.assign(3, {0, 0, 1});
    d.meshes[0].uvs[0].assign(3, {0.5f, 0.5f});
    d.meshes[0].colors.assign(3, {1, 1, 1, 1});
    d.meshes[0].indices = {0, 1, 2};
    d.nodes[0].shapes = {{MeshInstance{0}, 0, ""}, {Sphere{{0, 0, -9}, 1, {}}, 0, ""}};
    d.environment.kind = EnvironmentKind::gradient;
    add_light(d, {}, {});
    const auto print = [](const SceneDescription& s) {
        const Scene scene = compiled(s);
        return scene.data().key(scene.data().camera_record(scene.camera(), 8, 8));
    };
    std::set<std::string> seen{print(d)};
    EXPECT_EQ(print(d), *seen.begin());
    const std::vector<std::function<void(SceneDescription&)>> changes = {
        [](SceneDescription& s) { s.meshes[0].positions[0].x = 0.1f; },
        [](SceneDescription& s) { s.meshes[0].normals[0] = {1, 0, 0}; },
        [](SceneDescription& s) { s.meshes[0].uvs[0][1].x = 0.1f; },
        [](SceneDescription& s) { s.meshes[0].colors[1].y = 0.1f; },
        [](SceneDescription& s) { s.meshes[0].indices = {0, 2, 1}; },
        [](SceneDescription& s) { s.materials[0].base_color.value.g = 0.1f; },
        [](SceneDescription& s) { s.materials[0].roughness.value = 0.1f; },
        [](SceneDescription& s) { s.materials[0].kind = MaterialKind::metal; },
        [](SceneDescription& s) { s.textures[0].scale = 2; },
        [](SceneDescription& s) { s.textures[0].kind = TextureKind::marble; },
        [](SceneDescription& s) { s.textures[0].color_b.value.b = 0.1f; },
        [](SceneDescription& s) { s.environment.top.r = 0.1f; },
        [](SceneDescription& s) { s.environment.world_from_environment = Transform::rotate({1, 0, 0}, 1); },
        [](SceneDescription& s) { s.lights[0].intensity.r = 2; },
        [](SceneDescription& s) { s.nodes[1].parent_from_node = Transform::translate({1, 0, 0}); },
        [](SceneDescription& s) { std::get<Sphere>(s.nodes[0].shapes[1].geometry).radius = 1.1; },
        [](SceneDescription& s) { s.cameras[0].fov_y = 0.5; },
        [](SceneDescription& s) { s.cameras[0].aperture = 0.5; },
        [](SceneDescription& s) { s.cameras[0].position.x = 0.5; },
        [](SceneDescription& s) { s.cameras[0].shutter_close = 0.5; }};
    for (std::size_t i = 0; i < changes.size(); ++i) {
        SceneDescription other = d;
        changes[i](other);
        EXPECT_TRUE(seen.insert(print(other)).second) << "change " << i;
    }
}

/// IEC 61966-2-1, at codes on both sides of where its curve begins; numbers from the standard's formula, by hand.
TEST(ColorTable, LinearOfSrgb)
{
    const Scene scene = compiled(empty_scene());
    const auto& linear = scene.data().tables->linear_of_srgb;
    EXPECT_EQ(linear[0], 0);
    EXPECT_NEAR(linear[10], 0.00303527f, 1e-8);
    EXPECT_NEAR(linear[11], 0.00334654f, 1e-8);
    EXPECT_NEAR(linear[128], 0.21586050f, 1e-7);
    EXPECT_NEAR(linear[188], 0.50288646f, 1e-7);
    EXPECT_FLOAT_EQ(linear[255], 1);
}

/// Where it is at time 0, and what it moves by in a second, seen from the camera; radii in render units.
TEST(SphereTable, BeginsAtItsCentreAndEndsAtTheOther)
{
    SceneDescription d = empty_scene();
    d.cameras[0].position = {1, 2, 3};
    d.nodes[0].camera = -1;
    Node camera;
    camera.camera = 0;
    d.roots.push_back(1);
    d.nodes.push_back(camera);
    d.nodes[0].parent_from_node = Transform::translate({10, 0, 0}) * Transform::scale({2, 2, 2});
    d.nodes[0].shapes.push_back({Sphere{{1, 0, -4}, 0.5, Vec3d{2, 3, -8}}, -1, ""});
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    ASSERT_EQ(t.spheres.size(), 1u);
    const float s = float(t.render_scale);
    const SphereRecord& sphere = t.spheres[0];
    EXPECT_FLOAT_EQ(sphere.center.x / s, 10 + 2 - 1);
    EXPECT_FLOAT_EQ(sphere.center.y / s, -2);
    EXPECT_FLOAT_EQ(sphere.center.z / s, -8 - 3);
    EXPECT_FLOAT_EQ(sphere.motion.x / s, 2);
    EXPECT_FLOAT_EQ(sphere.motion.y / s, 6);
    EXPECT_FLOAT_EQ(sphere.motion.z / s, -8);
    EXPECT_FLOAT_EQ(sphere.radius / s, 1);
}

}  // namespace
}  // namespace fathom
