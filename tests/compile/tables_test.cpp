// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "compiled_scenes.h"

// Tests of compiled tables: most errors in them would show in an image only as noise, or where two errors cancel.
namespace fathom {
namespace {

TEST(MaterialTable, KeepsWhatTheMaterialSays)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -40}, 10, {}}, 0, ""});
    Material m;
    m.kind = MaterialKind::glass;
    m.base_color.value = {0.1f, 0.1f, 0.1f};
    m.transmission.color.value = {0.2f, 0.3f, 0.4f};
    m.interior.attenuation_color = {0.5f, 0.25f, 1};
    m.interior.attenuation_distance = 2;
    m.ior = 1.7f;
    m.roughness = {0.3f, -1, 2};
    m.metallic = {0.4f, -1, 1};
    m.opacity.alpha = {0.6f, -1, 0};
    m.opacity.cutoff = 0.7f, m.opacity.mode = AlphaMode::mask;
    m.fuzz = 0.8f, m.normal_map.scale = 0.9f;
    d.materials = {m, m, m, m, m};
    d.materials[1].interior.thin = true;
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
        // attenuation_color remains after attenuation_distance meters: exp(-sigma_t * distance) in render units.
        const double left[] = {0.5, 0.25, 1};
        EXPECT_NEAR(std::exp(-double(t.media[r.medium].extinction[c]) * 2 * t.render_scale), left[c], 1e-6);
        EXPECT_EQ(t.materials[2].emission[c], 0.1f);
    }
    const auto glass = r.parameters_as<GlassRecord>();
    EXPECT_EQ(glass.ior, 1.7f);
    EXPECT_EQ(t.media[r.medium].ior, 1.7f);
    // A thin sheet encloses index 1; opaque materials have no interior medium; medium 0 is empty space.
    const MediumRecord& enclosed = t.media[t.materials[1].medium];
    EXPECT_EQ(enclosed.ior, 1);
    EXPECT_EQ(enclosed.extinction, t.media[r.medium].extinction);
    EXPECT_TRUE(enclosed.is_index_matched && !t.media[r.medium].is_index_matched);
    EXPECT_EQ(t.materials[2].medium, 0u);
    EXPECT_EQ(t.media.size(), 3u);
    EXPECT_EQ(t.media[0].ior, 1);
    EXPECT_EQ(glass.roughness, 0.3f);
    EXPECT_EQ(glass.roughness_texture.channel, 2u);
    const auto principled = t.materials[3].parameters_as<PrincipledRecord>();
    EXPECT_EQ(principled.roughness, 0.3f);
    EXPECT_EQ(principled.roughness_texture.channel, 2u);
    EXPECT_EQ(principled.metallic, 0.4f);
    EXPECT_EQ(principled.metallic_texture.channel, 1u);
    EXPECT_EQ(r.alpha, 0.6f);
    EXPECT_EQ(r.alpha_channel, 0u);
    EXPECT_EQ(r.alpha_cutoff, 0.7f);
    EXPECT_EQ(r.alpha_mode, std::uint32_t(AlphaMode::mask));
    EXPECT_EQ(t.materials[4].parameters_as<FuzzMetalRecord>().fuzz, 0.8f);
    EXPECT_EQ(r.normal_scale, 0.9f);
    EXPECT_FALSE(r.features.has(MaterialFeature::thin));
    EXPECT_FALSE(glass.flags & GlassRecord::sheet);
    EXPECT_TRUE(t.materials[1].features.has(MaterialFeature::thin));
    EXPECT_TRUE(t.materials[1].parameters_as<GlassRecord>().flags & GlassRecord::sheet);
    EXPECT_TRUE(t.materials[2].features.has(MaterialFeature::unlit));
    EXPECT_EQ(t.materials[2].closure, ClosureKind::none);
    EXPECT_TRUE(t.lights.empty());
}

/// A texture of the subsurface color, radius or radius scale makes the medium depend on where the path entered.
TEST(MaterialTable, SubsurfacesOfAnyTexture)
{
    SceneDescription d = empty_scene();
    d.nodes[0].shapes.push_back({Sphere{{0, 0, -40}, 10, {}}, 0, ""});
    d.textures.emplace_back();
    d.textures[0].kind = TextureKind::checker_uv;
    Material m;
    m.kind = MaterialKind::principled;
    m.subsurface.weight.value = 1;
    d.materials = {m, m, m, m, m};
    d.materials[1].subsurface.color.texture = 0;
    d.materials[2].subsurface.radius.texture = 0;
    d.materials[3].subsurface.radius_scale.texture = 0;
    d.materials[4].subsurface.weight.texture = 0;
    const Scene scene = compiled(d);
    const SceneTables& t = *scene.data().tables;
    for (std::size_t i = 0; i < 5; ++i) {
        ASSERT_NE(t.materials[i].subsurface_medium, 0u) << i;
        // The medium where light enters belongs to the surface itself.
        EXPECT_EQ(t.media[t.materials[i].subsurface_medium].is_textured != 0, i >= 1 && i <= 3) << i;
    }
}

/// A scene of one material of a kind, compiled after a change of its parameters.
Scene scene_of(MaterialKind kind, const std::function<void(Material&)>& change)
{
    SceneDescription d = empty_scene();
    Material m;
    m.kind = kind;
    change(m);
    d.materials = {m};
    return compiled(d);
}

/// Each principled material is compiled to the simplest closure that supports its parameters.
TEST(MaterialTable, LayersAsNeeded)
{
    using enum ClosureKind;
    const auto closure = [](const std::function<void(Material&)>& change) {
        const Scene scene = scene_of(MaterialKind::principled, change);
        const SceneTables& t = *scene.data().tables;
        EXPECT_EQ(t.layers.size(), t.materials[0].closure == layered || t.materials[0].closure == layered_transmitting);
        return t.materials[0].closure;
    };
    EXPECT_EQ(closure([](Material&) {}), principled);
    EXPECT_EQ(closure([](Material& m) { m.metallic.value = 1; }), principled);
    EXPECT_EQ(closure([](Material& m) { m.transmission.weight.value = 1; }), glass);
    EXPECT_EQ(closure([](Material& m) { m.transmission.weight.value = 1, m.interior.thin = true; }), glass);
    EXPECT_EQ(closure([](Material& m) { m.transmission.weight.value = 1, m.metallic.value = 0.5f; }),
              layered_transmitting);
    EXPECT_EQ(closure([](Material& m) { m.transmission.weight.value = 0.5f; }), layered_transmitting);
    EXPECT_EQ(closure([](Material& m) { m.transmission.weight.value = 1, m.transmission.dispersion = 1; }),
              layered_transmitting);
    EXPECT_EQ(closure([](Material& m) { m.transmission.weight.value = 1, m.coat.weight.value = 1; }),
              layered_transmitting);
    EXPECT_EQ(closure([](Material& m) { m.diffuse_transmission.weight.value = 0.5f; }), layered_transmitting);
    const std::function<void(Material&)> changes[] = {[](Material& m) { m.coat.weight.value = 0.1f; },
                                                      [](Material& m) { m.sheen.color.value = {0, 0.1f, 0}; },
                                                      [](Material& m) { m.thin_film.weight.value = 0.1f; },
                                                      [](Material& m) { m.microfacets.anisotropy.value = 0.1f; },
                                                      [](Material& m) { m.diffuse_roughness.value = 1; },
                                                      [](Material& m) { m.specular.weight.value = 0.5f; },
                                                      [](Material& m) { m.specular.color.value.g = 0; },
                                                      [](Material& m) { m.conductor.edge_color.value.g = 0; }};
    for (const auto& change : changes) EXPECT_EQ(closure(change), layered);
}

TEST(MaterialTable, DisneysPassLightWhereAsked)
{
    const auto closure = [](const std::function<void(Material&)>& change) {
        return scene_of(MaterialKind::disney, change).data().tables->materials[0];
    };
    using enum ClosureKind;
    EXPECT_EQ(closure([](Material&) {}).closure, disney);
    EXPECT_EQ(closure([](Material& m) { m.diffuse_transmission.weight.value = 1; }).closure, disney);
    EXPECT_EQ(closure([](Material& m) { m.diffuse_transmission.weight.value = 1, m.interior.thin = true; }).closure,
              disney_transmitting);
    EXPECT_NE(closure([](Material& m) { m.transmission.weight.value = 1; }).medium, 0u);
    EXPECT_EQ(closure([](Material& m) { m.transmission.weight.value = 1, m.interior.thin = true; }).medium, 0u);
}

/// Share of diffusely reflected light that the dielectric boundary of index 1.5 reflects back inside, integrated
/// independently.
TEST(PlasticTable, LayersLoseAShareWithin)
{
    for (const auto& [thickness, lost] : {std::pair{0.0f, 0.0f}, {0.01f, 0.048598f}, {0.2f, 0.566788f}}) {
        const Scene scene =
            scene_of(MaterialKind::plastic, [&](Material& m) { m.plastic.optical_thickness = thickness; });
        const auto record = scene.data().tables->materials[0].parameters_as<PlasticRecord>();
        EXPECT_EQ(record.optical_thickness, thickness);
        EXPECT_NEAR(record.internal_absorption, lost, 2e-5);
    }
}

/// Energy compensation and the single-boundary flag of a principled material reach the simpler closures.
TEST(MaterialTable, CompensationAndOneBoundary)
{
    for (const bool compensated : {false, true}) {
        SceneDescription d = empty_scene();
        Material m;
        m.kind = MaterialKind::principled;
        m.microfacets.energy_compensation = compensated;
        m.transmission.weight.value = 1, m.interior.thin = true;
        d.materials = {m};
        d.nodes[0].shapes.push_back({Sphere{{0, 0, 0}, 1, {}}, 0, ""});
        const Scene scene = compiled(d);
        const MaterialRecord& r = scene.data().tables->materials[0];
        EXPECT_EQ(r.closure, ClosureKind::glass);
        const auto glass = r.parameters_as<GlassRecord>();
        EXPECT_EQ((glass.flags & facets::compensated) != 0, compensated);
        EXPECT_TRUE(r.features.has(MaterialFeature::thin));
        EXPECT_FALSE(glass.flags & GlassRecord::sheet);
    }
}

/// Camera record: right, up and forward form a right-handed frame; lengths are in render units.
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

/// Render space is centered at the camera and scaled by a power of two so that the scene's radius is 512 to 1024.
TEST(RenderSpace, BringsTheSceneToOneSize)
{
    for (double size : {1e-4, 1.0, 3.0, 777.0, 1e6}) {
        SceneDescription d = empty_scene();
        d.cameras[0].position = {size, size, 0}, d.cameras[0].look_at = {0, 0, 0};
        d.nodes[0].shapes.push_back({Box{{-size, -size, -size}, {size, size, size}}, -1, ""});
        const Scene scene = compiled(d);
        const SceneTables& t = *scene.data().tables;
        EXPECT_EQ(std::exp2(std::round(std::log2(t.render_scale))), t.render_scale);
        const double radius = 3 * size * t.render_scale;  // distance to the farthest corner
        EXPECT_GE(radius, 512) << size;
        EXPECT_LT(radius, 1024) << size;
        EXPECT_EQ(t.origin.x, size);
    }
}

/// Every property that changes an image changes the fingerprint, so films of different scenes are never merged.
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

/// IEC 61966-2-1 on both sides of the linear segment's end; expected values computed by hand from the standard's
/// formula.
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

/// Moving spheres store the center at time 0, relative to the camera, and the velocity per second; radii are in render
/// units.
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
