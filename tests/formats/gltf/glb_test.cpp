// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fathom/render.h"
#include "fathom/save.h"
#include "formats/import_test_helpers.h"
#include "formats/json/json.h"

// A scene written as GLB and read by our importer, which is tested with Khronos' sample models, renders the same.
// Features that glTF lacks are reported.
namespace fathom::test {
namespace {

namespace fs = std::filesystem;

std::uint32_t word_of(const std::string& bytes, std::size_t at)
{
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 4; ++i) word |= std::uint32_t(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
    return word;
}

class SaveGlb : public ImportTest {
protected:
    SceneDescription saved(const SceneDescription& scene, const std::string& name = "out.glb")
    {
        save_glb(scene, folder_ / name, told_);
        return load_scene(folder_ / name, {}, warnings_);
    }
    SceneDescription of_repository(const std::string& name)
    {
        return load_scene(fs::path(FATHOM_ROOT) / name, {}, warnings_);
    }
    Json json_of(const std::string& name = "out.glb")
    {
        const std::string bytes = bytes_of(folder_ / name);
        return Json::parse(bytes.substr(20, word_of(bytes, 12)));
    }
    bool has_warning(const std::string& what) const
    {
        return std::any_of(told_.counts().begin(), told_.counts().end(),
                           [&](const auto& told) { return told.first.find(what) != std::string::npos; });
    }
    /// Mean radiance of the image of the scene's own camera.
    Vec3d mean(SceneDescription scene, std::uint64_t samples)
    {
        add_default_camera(scene, {});
        Warnings warnings;
        RenderSettings settings;
        settings.width = 40, settings.height = 40;
        const RenderJob job(Scene::compile(scene, "", warnings), settings);
        Vec3d sum;
        for (int y = 0; y < settings.height; ++y)
            for (int x = 0; x < settings.width; ++x)
                for (std::uint64_t i = 0; i < samples; ++i) {
                    const Color c = render_sample(job, x, y, i);
                    sum = sum + Vec3d{double(c.r), double(c.g), double(c.b)};
                }
        return sum * (1.0 / (double(samples) * settings.width * settings.height));
    }
    static std::uint64_t fingerprint(SceneDescription scene)
    {
        add_default_camera(scene, {});
        Warnings warnings;
        return Scene::compile(scene, "", warnings).fingerprint();
    }

    Warnings told_;
};

// ------------------------------------------------------------------------------------------- preserved features

/// glTF files survive bit for bit.
TEST_F(SaveGlb, ModelsOfGltfAreTheSame)
{
    for (const char* name : {"scenes/models/chess.glb", "scenes/models/still-life.glb", "tests/golden/scenes/model.glb",
                             "tests/golden/scenes/model.gltf"}) {
        const SceneDescription scene = of_repository(name);
        EXPECT_EQ(fingerprint(saved(scene)), fingerprint(scene)) << name;
        EXPECT_TRUE(told_.empty()) << name << ": " << told_.counts().begin()->first;
    }
}

/// Each material layer is written as its extension and checked in the reloaded scene.
TEST_F(SaveGlb, LayersOfMaterials)
{
    const SceneDescription scene = load("layers.json", R"({"fathom": 1, "materials": {
        "a": {"kind": "principled", "color": [0.5, 0.25, 0.125], "metallic": 0.25, "roughness": 0.75, "ior": 1.75,
              "specular": 0.5, "specular_color": [1.5, 1, 0.5], "coat": 0.625, "coat_roughness": 0.125, "coat_darkening": 0,
              "anisotropy": 0.375, "sheen_color": [0.5, 0.75, 1], "sheen_roughness": 0.5,
              "thin_film": 0.25, "thin_film_thickness": 500, "thin_film_ior": 1.625, "emission": [4, 2, 1], "alpha": 0.75, "alpha_mode": "blend"},
        "b": {"kind": "glass", "ior": 1.25, "roughness": 0.25, "attenuation_color": [0.5, 0.75, 1], "attenuation_distance": 2},
        "c": {"kind": "principled", "transmission": 1, "transmission_color": [0.5, 1, 0.25], "thin": true},
        "d": {"kind": "metal", "color": [1, 0.75, 0.5], "roughness": 0.5},
        "e": {"kind": "unlit", "color": [0.25, 0.5, 1]}},
      "scene": [{"box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "material": "a"}, {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "material": "b"},
                {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "material": "c"}, {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "material": "d"},
                {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "material": "e"}]})");
    const SceneDescription again = saved(scene);
    ASSERT_EQ(again.materials.size(), 5u);
    const Material &a = again.materials[0], &b = again.materials[1], &c = again.materials[2], &d = again.materials[3];
    EXPECT_EQ(a.base_color.value, (Color{0.5f, 0.25f, 0.125f}));
    EXPECT_EQ(a.metallic.value, 0.25f);
    EXPECT_EQ(a.roughness.value, 0.75f);
    EXPECT_EQ(a.ior, 1.75f);
    EXPECT_EQ(a.specular.weight.value, 0.5f);
    EXPECT_EQ(a.specular.color.value, (Color{1.5f, 1, 0.5f}));
    EXPECT_EQ(a.coat.weight.value, 0.625f);
    EXPECT_EQ(a.coat.roughness.value, 0.125f);
    EXPECT_EQ(a.microfacets.anisotropy.value, 0.375f);
    EXPECT_EQ(a.sheen.color.value, (Color{0.5f, 0.75f, 1}));
    EXPECT_EQ(a.sheen.roughness.value, 0.5f);
    EXPECT_EQ(a.thin_film.weight.value, 0.25f);
    EXPECT_EQ(a.thin_film.thickness.value, 500);
    EXPECT_EQ(a.thin_film.ior, 1.625f);
    EXPECT_EQ(a.emission.radiance.value, (Color{4, 2, 1}));
    EXPECT_EQ(a.opacity.alpha.value, 0.75f);
    EXPECT_EQ(a.opacity.mode, AlphaMode::blend);
    EXPECT_EQ(b.transmission.weight.value, 1);
    EXPECT_EQ(b.metallic.value, 0);
    EXPECT_EQ(b.ior, 1.25f);
    EXPECT_EQ(b.roughness.value, 0.25f);
    EXPECT_EQ(b.interior.attenuation_color, (Color{0.5f, 0.75f, 1}));
    EXPECT_EQ(b.interior.attenuation_distance, 2);
    EXPECT_FALSE(b.interior.thin);
    EXPECT_EQ(c.transmission.color.value, (Color{0.5f, 1, 0.25f}));
    EXPECT_TRUE(c.interior.thin);
    EXPECT_EQ(d.metallic.value, 1);
    EXPECT_EQ(d.roughness.value, 0.5f);
    EXPECT_EQ(again.materials[4].kind, MaterialKind::unlit);
}

/// Two roughnesses become glTF's anisotropy, which stretches facets along the rougher axis.
TEST_F(SaveGlb, TwoRoughnesses)
{
    const SceneDescription again = saved(load("rough.json", R"({"fathom": 1, "materials": {
        "u": {"kind": "principled", "two_roughnesses": true, "anisotropy": 0.75, "roughness": 0.5},
        "v": {"kind": "principled", "two_roughnesses": true, "anisotropy": 0.5, "roughness": 0.75, "separable_shadowing": true}},
        "scene": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "material": "u"}, {"sphere": {"center": [0, 0, 0], "radius": 1}, "material": "v"}]})"));
    ASSERT_EQ(again.materials.size(), 2u);
    for (const Material& m : again.materials) {
        EXPECT_EQ(m.roughness.value, 0.5f);
        const double a = double(m.microfacets.anisotropy.value) * double(m.microfacets.anisotropy.value);
        EXPECT_NEAR(0.25 + 0.75 * a, 0.75 * 0.75, 1e-6);
    }
    EXPECT_EQ(again.materials[0].microfacets.anisotropy_rotation, 0);
    EXPECT_NEAR(again.materials[1].microfacets.anisotropy_rotation, 1.5707963268, 1e-6);
    EXPECT_TRUE(has_warning("separable masking-shadowing"));
}

/// A diffuse room keeps its mean radiance; samples differ because rectangles become triangles.
TEST_F(SaveGlb, RoomsHaveTheirLight)
{
    const SceneDescription room = of_repository("scenes/cornell-box.json");
    for (const Material& m : saved(room).materials)
        EXPECT_EQ(m.specular.weight.value, 0) << m.name << ": no boundary reflects";
    const Vec3d was = mean(room, 64), is = mean(saved(room), 64);
    EXPECT_NEAR(is.x, was.x, 0.02 * was.x);
    EXPECT_NEAR(is.y, was.y, 0.02 * was.y);
    EXPECT_NEAR(is.z, was.z, 0.02 * was.z);
    EXPECT_GT(was.x, 0.05);
}

TEST_F(SaveGlb, PlacesLightsAndCameras)
{
    const SceneDescription again = saved(load("places.json", R"({"fathom": 1,
        "cameras": {"c": {"position": [1, 2, 3], "look_at": [1, 2, 8], "fov_y_deg": 45}},
        "lights": {"s": {"kind": "spot", "color": [8, 4, 2], "inner_angle_deg": 30, "outer_angle_deg": 30}},
        "nodes": {"pair": {"sphere": {"center": [0, 0, 0], "radius": 0.5}}},
        "scene": [{"camera": "c"}, {"light": "s", "transform": {"translate": [0, 5, 0]}},
                  {"children": ["pair"], "transform": {"translate": [1, 0, 0]}}, {"children": ["pair"], "transform": {"translate": [2, 0, 0]}}]})"));
    ASSERT_EQ(again.cameras.size(), 1u);
    EXPECT_NEAR(again.cameras[0].fov_y, 0.7853981634, 1e-9);
    ASSERT_EQ(again.lights.size(), 1u);
    EXPECT_EQ(again.lights[0].intensity, (Color{8, 4, 2}));
    EXPECT_NEAR(again.lights[0].outer_angle, 0.5235987756, 1e-9);
    const Json json = json_of();
    // Both spheres share one mesh.
    EXPECT_EQ(json["meshes"].size(), 1u);
    // The camera looks along +z, so its x axis is the scene's -x.
    const auto camera =
        std::find_if(json["nodes"].begin(), json["nodes"].end(), [](const Json& n) { return n.contains("camera"); });
    ASSERT_NE(camera, json["nodes"].end());
    EXPECT_EQ((*camera)["matrix"], (Json{-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 1, 2, 3, 1}));
    EXPECT_TRUE(has_warning("spheres are written as triangles"));
}

/// glTF has no image-textured lights, so they are reported.
TEST_F(SaveGlb, TellsOfPicturesOfLights)
{
    write("p.ppm", "P6\n1 1\n255\nabc");
    const SceneDescription again = saved(load("lights.json", R"({"fathom": 1, "lights": {
        "a": {"kind": "projector", "image": "p.ppm", "fov_deg": 60, "color": [8, 4, 2]},
        "b": {"kind": "goniometric", "image": "p.ppm", "intensity": 12.566370614, "unit": "lm"}},
        "scene": [{"light": "a"}, {"light": "b"}]})"));
    ASSERT_EQ(again.lights.size(), 2u);
    EXPECT_EQ(again.lights[0].kind, LightKind::spot);
    EXPECT_NEAR(again.lights[0].outer_angle, 0.5235987756, 1e-9);
    EXPECT_EQ(again.lights[0].intensity, (Color{8, 4, 2}));
    EXPECT_EQ(again.lights[1].kind, LightKind::point);
    EXPECT_NEAR(again.lights[1].intensity.g, 1, 1e-6);
    EXPECT_TRUE(has_warning("light images are not written"));
}

/// The byte layout follows the GLB specification.
TEST_F(SaveGlb, Container)
{
    saved(of_repository("scenes/models/still-life.glb"));
    const std::string bytes = bytes_of(folder_ / "out.glb");
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word_of(bytes, 4), 2u);
    EXPECT_EQ(word_of(bytes, 8), bytes.size());
    const std::size_t json_size = word_of(bytes, 12);
    EXPECT_EQ(json_size % 4, 0u);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    EXPECT_EQ(bytes.substr(24 + json_size, 4), std::string("BIN\0", 4));
    EXPECT_EQ(28 + json_size + word_of(bytes, 20 + json_size), bytes.size());
    const Json json = json_of();
    for (const Json& view : json["bufferViews"]) EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);
    for (const Json& mesh : json["meshes"])
        for (const Json& primitive : mesh["primitives"]) {
            const Json& positions = json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
            EXPECT_EQ(positions["min"].size(), 3u);
            EXPECT_LE(positions["min"][0].get<double>(), positions["max"][0].get<double>());
        }
}

// ----------------------------------------------------------------------------------------------- reported losses

TEST_F(SaveGlb, WhatGltfCanNotSay)
{
    const SceneDescription again = saved(load("rich.json", R"({"fathom": 1, "render": {"samples": 64},
        "environment": {"kind": "constant", "color": [1, 1, 1]},
        "textures": {"t": {"kind": "checker_uv", "color_a": [0, 0, 0], "color_b": [0.5, 1, 0.25]}},
        "materials": {"a": {"kind": "diffuse", "color": "t"},
                      "b": {"kind": "principled", "subsurface": 0.5, "coat": 1, "coat_color": [1, 0, 0]}},
        "scene": [{"rectangle": {"corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}, "material": "a"},
                  {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "material": "b"}]})"));
    for (const char* what :
         {"environment", "render settings", "material 'a': glTF can't express a procedural texture",
          "material 'b': glTF can't express subsurface", "material 'b': glTF can't express a coat's color"})
        EXPECT_TRUE(has_warning(what)) << what;
    EXPECT_EQ(again.materials[0].base_color.value, (Color{0.25f, 0.5f, 0.125f})) << "its mean";
    EXPECT_EQ(again.environment.kind, EnvironmentKind::none);
}

TEST_F(SaveGlb, DoesNotOverwriteWhatWasRead)
{
    const SceneDescription scene = of_repository("scenes/models/chess.glb");
    fs::copy(fs::path(FATHOM_ROOT) / "scenes/models/chess.glb", folder_ / "chess.glb");
    const SceneDescription copy = load_scene(folder_ / "chess.glb", {}, warnings_);
    EXPECT_THROW(save_glb(copy, folder_ / "chess.glb", told_), Error);
    EXPECT_EQ(bytes_of(folder_ / "chess.glb"), bytes_of(fs::path(FATHOM_ROOT) / "scenes/models/chess.glb"));
}

}  // namespace
}  // namespace fathom::test
