// SPDX-License-Identifier: Apache-2.0
#include "fathom/save.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

#include "fathom/render.h"
#include "formats/import_test_helpers.h"

// Tests that saving and reloading a scene preserves the fingerprint of its compiled tables and its camera.
namespace fathom::test {
namespace {

namespace fs = std::filesystem;

void expect_same_files(const std::map<std::string, std::string>& a, const std::map<std::string, std::string>& b)
{
    for (const auto& [name, bytes] : a) EXPECT_TRUE(b.contains(name) && b.at(name) == bytes) << name;
    EXPECT_EQ(a.size(), b.size());
}

/// Contents of all files below a folder.
std::map<std::string, std::string> files_of(const fs::path& folder)
{
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files[entry.path().lexically_relative(folder).string()] = bytes_of(entry.path());
    return files;
}

struct Rendered {
    std::uint64_t fingerprint;
    std::string key;  ///< fingerprint of the tables and the camera
    bool camera_added;
};
Rendered rendered(SceneDescription scene)
{
    Warnings warnings;
    Rendered result;
    result.camera_added = add_default_camera(scene, {});
    const Scene compiled = Scene::compile(scene, "", warnings);
    result.fingerprint = compiled.fingerprint();
    result.key = RenderJob(compiled, {}).key().text();
    return result;
}

class Save : public ImportTest {
protected:
    fs::path target(const std::string& name)
    {
        fs::create_directories(folder_ / name);
        return folder_ / name / "scene.json";
    }
    SceneDescription saved(const SceneDescription& scene, const std::string& name = "out")
    {
        save_scene(scene, target(name), save_warnings_);
        return load_scene(target(name), {}, warnings_);
    }
    /// A saved scene renders the same when reloaded, and saving it again gives an identical file.
    void expect_same(const SceneDescription& scene)
    {
        const SceneDescription again = saved(scene);
        for (const auto& [message, count] : save_warnings_.counts()) ADD_FAILURE() << message;
        const Rendered a = rendered(scene), b = rendered(again);
        EXPECT_EQ(a.fingerprint, b.fingerprint);
        EXPECT_EQ(a.key, b.key);
        EXPECT_EQ(a.camera_added, b.camera_added);
        expect_same_counts(scene, again);
        save_scene(scene, target("twice"), save_warnings_);
        expect_same_files(files_of(folder_ / "out"), files_of(folder_ / "twice"));
        expect_stable(again);
    }
    static void expect_same_counts(const SceneDescription& a, const SceneDescription& b)
    {
        EXPECT_EQ(a.meshes.size(), b.meshes.size());
        EXPECT_EQ(a.curves.size(), b.curves.size());
        EXPECT_EQ(a.points.size(), b.points.size());
        EXPECT_EQ(a.textures.size(), b.textures.size());
        EXPECT_EQ(a.materials.size(), b.materials.size());
        EXPECT_EQ(a.lights.size(), b.lights.size());
        EXPECT_EQ(a.cameras.size(), b.cameras.size());
    }
    /// A reloaded scene is saved to an identical file, except that images stay where they are.
    void expect_stable(const SceneDescription& again)
    {
        if (!again.images.empty()) return;
        saved(again, "third");
        expect_same_files(files_of(folder_ / "out"), files_of(folder_ / "third"));
    }

    Warnings save_warnings_;
};

class SaveFile : public Save, public ::testing::WithParamInterface<fs::path> {};

std::vector<fs::path> scenes()
{
    std::vector<fs::path> files;
    for (const char* folder : {"scenes", "scenes/models", "tests/golden/scenes"})
        for (const auto& entry : fs::directory_iterator(fs::path(FATHOM_ROOT) / folder)) {
            const std::string extension = entry.path().extension().string();
            for (const char* known : {".json", ".gltf", ".glb", ".obj", ".ply", ".stl"})
                if (extension == known) files.push_back(entry.path());
        }
    std::sort(files.begin(), files.end());
    return files;
}

TEST_P(SaveFile, RendersTheSame)
{
    expect_same(load_scene(GetParam(), {}, warnings_));
}
INSTANTIATE_TEST_SUITE_P(Scenes, SaveFile, ::testing::ValuesIn(scenes()), [](const auto& file) {
    std::string name = file.param.lexically_relative(FATHOM_ROOT).string();
    std::replace_if(name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
    return name;
});

// --------------------------------------------------------------------------------------------- rarely used features

std::vector<std::byte> bytes_of_picture(const char* name)
{
    const std::string bytes = bytes_of(fs::path(FATHOM_ROOT) / "tests/golden/scenes" / name);
    std::vector<std::byte> result;
    for (const char c : bytes) result.push_back(std::byte(c));
    return result;
}

/// Adds a root node with one shape.
Node& add_shape(SceneDescription& scene, decltype(Shape::geometry) geometry, int material = -1)
{
    scene.roots.push_back(int(scene.nodes.size()));
    Node& node = scene.nodes.emplace_back();
    node.shapes.push_back({geometry, material, ""});
    return node;
}

Mesh triangle()
{
    Mesh mesh;
    mesh.positions = {{0, 0, -3}, {1, 0, -3}, {0.1f, 1, -3}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

TEST_F(Save, EveryVectorOfAMesh)
{
    SceneDescription scene;
    Mesh mesh = triangle();
    mesh.normals.assign(3, {0, 0.6f, 0.8f});
    mesh.tangents.assign(3, {1, 0, 0, -1});
    // 1 - v cannot restore these values exactly.
    mesh.uvs[0] = {{1e-20f, 1e-20f}, {0.1f, -0.1f}, {3, 1e-9f}};
    mesh.uvs[1] = {{0, 1}, {0.3f, 0.7f}, {0.123456789f, -0.0f}};
    mesh.colors.assign(3, {0.1f, 0.2f, 0.3f, 0.4f});
    mesh.motion = {{0, mesh.positions, mesh.normals}, {0.5, mesh.positions, mesh.normals}};
    mesh.motion[1].positions[0].x = 0.25f;
    scene.meshes = {mesh};
    add_shape(scene, MeshInstance{0});
    scene.cameras.emplace_back().shutter_close = 0.5;
    scene.cameras[0].shift_x = 0.25, scene.cameras[0].shift_y = -0.5;
    scene.nodes[0].camera = 0;
    expect_same(scene);
    const SceneDescription again = saved(scene);
    ASSERT_EQ(again.meshes[0].uvs[0].size(), 3u);
    ASSERT_EQ(again.meshes[0].uvs[1].size(), 3u);
    for (std::size_t set = 0; set < 2; ++set)
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(again.meshes[0].uvs[set][i].x, mesh.uvs[set][i].x);
            EXPECT_EQ(again.meshes[0].uvs[set][i].y, mesh.uvs[set][i].y);
        }
    EXPECT_EQ(again.meshes[0].motion.size(), 2u);
}

TEST_F(Save, CurvesAndPointsThatNodesShare)
{
    SceneDescription scene;
    Curves curves;
    curves.basis = CurveBasis::linear;
    curves.ribbons = true;
    curves.points = {{0, 0, -3}, {1, 0, -3}, {0, 1, -3}, {1, 1, -3}, {1, 2, -3}};
    curves.radii = {0.1f, 0.01f, 0.02f, 0, 0.3f};
    curves.counts = {2, 3};
    curves.motion = {{0, curves.points, curves.radii}, {0.5, curves.points, curves.radii}};
    curves.motion[1].points[4].x = 1.5f;
    curves.motion[1].radii[3] = 0.2f;
    scene.curves = {curves};
    scene.cameras.emplace_back().shutter_close = 0.5;
    scene.points.push_back({"", {{0, 0, -4}, {1, 1, -4}}, {0.1f, 0.2f}});
    add_shape(scene, CurvesInstance{0});
    add_shape(scene, CurvesInstance{0}).parent_from_node = Transform::translate({3, 0, 0});
    add_shape(scene, PointsInstance{0});
    add_shape(scene, PointsInstance{0}).parent_from_node = Transform::translate({0, 3, 0});
    scene.nodes[0].camera = 0;
    expect_same(scene);
    const SceneDescription again = saved(scene);
    ASSERT_EQ(again.curves.size(), 1u);
    ASSERT_EQ(again.curves[0].motion.size(), 2u);
    EXPECT_EQ(again.curves[0].motion[1].points[4].x, 1.5f);
    EXPECT_EQ(again.curves[0].motion[1].radii, curves.motion[1].radii);
    EXPECT_EQ(again.points.size(), 1u);
}

/// Measured tables are saved beside the scene; spectra are saved as RGB.
TEST_F(Save, MeasuredMaterials)
{
    const SceneDescription golden =
        load_scene(fs::path(FATHOM_ROOT) / "tests/golden/scenes/measured.json", {}, warnings_);
    ASSERT_EQ(golden.measured.size(), 2u);
    SceneDescription scene;
    scene.measured = golden.measured;
    scene.measured[1].name.clear();
    scene.measured[1].color_is_per_facet = false;
    scene.measured.push_back(scene.measured[0]);  // not used by any material
    scene.materials.resize(2);
    for (int i = 0; i < 2; ++i) {
        scene.materials[std::size_t(i)].kind = MaterialKind::measured;
        scene.materials[std::size_t(i)].measured = i;
        add_shape(scene, Sphere{}, i).parent_from_node = Transform::translate({double(3 * i), 0, -4});
    }
    scene.cameras.emplace_back();
    scene.nodes[0].camera = 0;
    const SceneDescription again = saved(scene);
    ASSERT_EQ(again.measured.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const MeasuredBrdf &a = scene.measured[i], &b = again.measured[i];
        EXPECT_EQ(a.theta, b.theta);
        EXPECT_EQ(a.phi, b.phi);
        EXPECT_EQ(a.color_is_per_facet, b.color_is_per_facet);
        for (const auto table : {&MeasuredBrdf::ndf, &MeasuredBrdf::sigma, &MeasuredBrdf::vndf,
                                 &MeasuredBrdf::luminance, &MeasuredBrdf::color}) {
            EXPECT_EQ((a.*table).width, (b.*table).width);
            EXPECT_EQ((a.*table).height, (b.*table).height);
            EXPECT_EQ((a.*table).values, (b.*table).values);
        }
    }
    scene.measured.pop_back();
    expect_same(scene);
}

/// Every number differs from its default, including parameters that a light kind does not use.
TEST_F(Save, LightsWithPictures)
{
    SceneDescription scene;
    scene.images = {{"p.ppm", write("p.ppm", "P6\n1 1\n255\nabc"), {}},
                    {"lamp.ies", {}, {}},
                    {"q.ppm", write("q.ppm", "P6\n2 1\n255\nabcdef"), {}}};
    for (const char c : std::string("IESNA:LM-63-2002\nTILT=NONE\n1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 5 3"))
        scene.images[1].bytes.push_back(std::byte(c));
    scene.meshes = {triangle()};
    add_shape(scene, MeshInstance{0});
    scene.lights.resize(10);
    for (Light& light : scene.lights) {
        light.kind = LightKind::projector;
        light.intensity = {1, 2, 3};
    }
    scene.lights[0].picture = {2, ColorSpace::linear, true};
    scene.lights[0].fov = 0.3, scene.lights[0].fov_axis = FovAxis::diagonal;
    scene.lights[1].flat_field = true;
    scene.lights[2].intensity_is_flux = true;
    scene.lights[3].kind = LightKind::goniometric, scene.lights[3].picture.image = 1;
    scene.lights[4].kind = LightKind::goniometric, scene.lights[4].picture.image = 0;
    scene.lights[4].intensity_is_flux = true;
    scene.lights[5].kind = LightKind::spot, scene.lights[5].picture = {2, ColorSpace::srgb, true};
    scene.lights[5].falloff = SpotFalloff::linear;
    scene.lights[5].intensity_is_flux = true;  // ignored for a spot light
    for (const int beam : {6, 7}) scene.lights[std::size_t(beam)].kind = LightKind::beam;
    scene.lights[7].width = 0.3, scene.lights[7].height = 0.2, scene.lights[7].round = true;
    for (const int tube : {8, 9}) scene.lights[std::size_t(tube)].kind = LightKind::tube;
    scene.lights[9].length = 1.3, scene.lights[9].radius = 0.02, scene.lights[9].intensity_is_flux = true;
    for (int light = 0; light < 10; ++light) {
        Node node;
        node.light = light;
        node.parent_from_node = Transform::rotate({1, 2, 3}, light) * Transform::scale({light % 2 ? -1.0 : 1.0, 1, 1});
        scene.roots.push_back(int(scene.nodes.size()));
        scene.nodes.push_back(node);
    }
    expect_same(scene);
}

/// Nodes may have several shapes or parents; a light and a camera have two placements, and transforms flatten or
/// mirror.
TEST_F(Save, NodesOfEveryKind)
{
    SceneDescription scene;
    scene.meshes = {triangle()};
    Node& many = add_shape(scene, MeshInstance{0});
    many.name = "many";
    many.shapes.push_back({Sphere{{0, 0, -5}, -0.5, Vec3d{0, 1, -5}}, -1, "ball"});
    many.shapes.push_back({Box{{-1, -1, -9}, {1, 1, -8}}, -1, ""});
    many.shapes.push_back({Disk{{0, 2, -5}, {0, 0.1, 1}, 0.3}, -1, ""});
    many.parent_from_node.m = {{{1, 0.1, 0, 0.123456789012345}, {0, -1, 0.2, 1e-17}, {0, 0, 1, -0.0}}};
    add_shape(scene, Rectangle{{0, 0, -4}, {1, 0, 0}, {0, 1, 0}}).parent_from_node = Transform::scale({1, 1, 0});
    scene.lights.resize(3);
    scene.lights[0] = {"spot", LightKind::spot, {1, 2, 3}, 0.1, 1.5707964, 0};
    scene.lights[1] = {"sun", LightKind::directional, {0.1f, 0.1f, 0.1f}, 0, Light().outer_angle, 0.00925};
    scene.lights[2] = {"bulb", LightKind::point, {5, 5, 5}};
    scene.cameras.resize(2);
    scene.cameras[0].name = "same";
    scene.cameras[1].name = "same";
    scene.cameras[1].kind = CameraKind::orthographic;
    scene.cameras[1].height = 3.3;
    for (int light = 0; light < 3; ++light) {
        Node node;
        node.light = light;
        node.camera = std::min(light, 1);
        node.parent_from_node = Transform::rotate({1, 2, 3}, light);
        scene.nodes.push_back(node);
    }
    // The spot light's node has two parents, hence two placements.
    Node group;
    group.children = {2, 2, 3};
    group.motion = {{0, Transform::translate({1, 0, 0})}, {1, Transform::translate({1, 0.1, 0})}};
    scene.roots.insert(scene.roots.end(), {5, 5, 4, 2});
    scene.nodes.push_back(group);
    expect_same(scene);
    const SceneDescription again = saved(scene);
    // A light with several placements is still one node.
    std::size_t spots = 0;
    for (const Node& node : again.nodes)
        spots += node.light >= 0 && again.lights[std::size_t(node.light)].kind == LightKind::spot;
    EXPECT_EQ(spots, 1u);
    ASSERT_EQ(again.cameras.size(), 2u);
    EXPECT_EQ(again.cameras[0].name, "same");
    EXPECT_EQ(again.cameras[1].name, "same");
    EXPECT_EQ(again.cameras[1].kind, CameraKind::orthographic);
}

TEST_F(Save, PicturesInAndOutsideOfTheScene)
{
    SceneDescription scene;
    ImageFile inside;
    inside.name = "Bands / of colour";
    inside.bytes = bytes_of_picture("bands.png");
    scene.images = {inside, {"bumps", fs::path(FATHOM_ROOT) / "tests/golden/scenes/bumps.png", {}}, inside};
    scene.images[2].bytes = bytes_of_picture("sky.hdr");
    scene.environment.kind = EnvironmentKind::image;
    scene.environment.image = 2;
    scene.environment.color = {0.5f, 0.25f, 1};
    scene.environment.world_from_environment = Transform::rotate({0.3, 1, 0.2}, 0.7);
    Texture bands, bumps;
    bands.name = bumps.name = "same";
    bands.image = 0;
    bands.wrap_u = Wrap::mirror, bands.wrap_v = Wrap::clamp;
    bands.nearest = true;
    bands.uv_offset = {0.1f, 0.2f}, bands.uv_scale = {-3, 0.3f}, bands.uv_rotation = 0.1f;
    bumps.image = 1;
    bumps.color_space = ColorSpace::linear;
    bumps.height_scale = -0.02f;
    scene.textures = {bands, bumps};
    Material m;
    m.kind = MaterialKind::principled;
    m.base_color = {{0.5f, 0.6f, 0.7f}, 0};
    m.opacity.alpha = {0.5f, 0, 3};
    m.roughness = {0.3f, 0, 0};
    m.metallic = {0.1f, -1, 3};
    m.normal_map.texture = 1;
    m.opacity.mode = AlphaMode::opaque;
    m.emission.radiance = {{1e-7f, 0, 123456.7f}, 0};
    scene.materials = {m};
    add_shape(scene, Sphere{{0, 0, -3}, 1, {}}, 0);
    expect_same(scene);
    const SceneDescription again = saved(scene);
    EXPECT_EQ(again.textures.size(), 2u);
    EXPECT_EQ(bytes_of(again.images[0].path), bytes_of(fs::path(FATHOM_ROOT) / "tests/golden/scenes/bands.png"));
    EXPECT_TRUE(fs::equivalent(again.images[1].path, scene.images[1].path));
}

TEST_F(Save, PicturesAreNamedAsTheirBytesSay)
{
    for (const char* const extension : {".png", ".jpg", ".webp", ".avif", ".hdr", ".exr"}) {
        Image picture;
        picture.width = picture.height = 2;
        picture.layers.push_back({"", {"R", "G", "B"}, std::vector<float>(12, 0.5f)});
        const fs::path file = folder_ / (std::string("picture") + extension);
        write_image(file, picture, {});
        SceneDescription scene;
        const std::string bytes = bytes_of(file);
        scene.images.push_back({"inside", {}, {}});
        scene.images[0].bytes.resize(bytes.size());
        std::memcpy(scene.images[0].bytes.data(), bytes.data(), bytes.size());
        scene.textures.resize(1);
        scene.textures[0].image = 0;
        scene.materials.resize(1);
        scene.materials[0].base_color.texture = 0;
        add_shape(scene, Sphere{{0, 0, -3}, 1, {}}, 0);
        EXPECT_EQ(saved(scene).images.at(0).path.extension(), extension);
    }
}

/// Parameters that a kind does not use have no effect, neither in memory nor in a file.
TEST_F(Save, ASkyWithItsSun)
{
    SceneDescription scene;
    scene.environment.kind = EnvironmentKind::sky;
    scene.environment.to_sun = {0.25, 0.1, -0.7};
    scene.environment.sky_ground = false;
    scene.environment.color = {2, 1, 0.5f};
    scene.environment.world_from_environment = Transform::rotate({0, 1, 0}, 0.7);
    for (const bool sun : {true, false}) {
        scene.environment.sun_disk = sun;
        expect_same(scene);
        const Environment again = saved(scene).environment;
        EXPECT_EQ(again.to_sun, scene.environment.to_sun);
        EXPECT_EQ(again.sky_ground, scene.environment.sky_ground);
        EXPECT_EQ(again.sun_disk, sun);
    }
}

TEST_F(Save, ACubeOfPictures)
{
    SceneDescription scene;
    for (int i = 0; i < 6; ++i) {
        scene.images.push_back({"face " + std::to_string(i), {}, bytes_of_picture(i % 2 ? "bands.png" : "sky.hdr")});
        scene.environment.faces[std::size_t(i)] = 5 - i;
    }
    scene.environment.kind = EnvironmentKind::cube;
    scene.environment.color = {2, 1, 0.5f};
    scene.environment.world_from_environment = Transform::rotate({0, 1, 0}, 0.7);
    expect_same(scene);
    std::swap(scene.environment.faces[0], scene.environment.faces[1]);
    const std::uint64_t swapped = rendered(scene).fingerprint;
    std::swap(scene.environment.faces[0], scene.environment.faces[1]);
    EXPECT_NE(rendered(scene).fingerprint, swapped);
}

TEST_F(Save, WhatAKindDoesNotHaveIsNotCompiled)
{
    SceneDescription scene;
    Material plain, odd;
    odd.fuzz = 0.5f, odd.ior = 2, odd.metallic.value = 0.5f, odd.interior.attenuation_distance = 3,
    odd.interior.thin = true;
    add_shape(scene, Sphere{{0, 0, -3}, 1, {}}, 0);
    scene.materials = {plain};
    const std::uint64_t fingerprint = rendered(scene).fingerprint;
    scene.materials = {odd};
    EXPECT_EQ(rendered(scene).fingerprint, fingerprint);
    expect_same(scene);
}

/// Every texture kind refers to the next one; a reader finds them in this order.
TEST_F(Save, GraphsOfTextures)
{
    SceneDescription scene;
    for (int kind = 1; kind < texture_kind_count; ++kind) {
        Texture t;
        t.kind = TextureKind(kind);
        // Each texture refers to the next one except every fourth: graphs are limited to a depth of 16.
        const bool is_last = kind % 4 == 0 || kind == texture_kind_count - 1;
        t.color_a = {{0.25f, 0.5f, 0.75f}, is_last ? -1 : kind};
        t.color_b = {{0.1f, 0.1f, 0.3f}, -1};
        t.factor = {0.5f, is_last ? -1 : kind, 2};
        t.stops = {{0.1f, {1, 2, 3}}, {0.7f, {0.1f, 0.1f, 0.1f}}};
        t.scale = 0.3f, t.octaves = 5, t.gain = 0.7f, t.turbulence_weight = 0.1f, t.uv_set = 1;
        t.direction = {0.1, -2, 3};
        t.mapping = TextureMapping(kind % 4);
        t.world_from_texture = Transform::translate({1, 2, 3}) * Transform::rotate({0.3, 1, 0.2}, 0.7);
        scene.textures.push_back(t);
    }
    Material m;
    m.base_color.texture = 3;
    m.roughness = {1, 9, 2};
    m.bump = {0.01f, 5, 1};
    scene.materials = {m};
    add_shape(scene, Sphere{{0, 0, -3}, 1, {}}, 0);
    expect_same(scene);
}

TEST_F(Save, HintsForRendering)
{
    SceneDescription scene;
    RenderHints& h = scene.hints;
    h.width = 7, h.height = 9, h.samples = 3, h.max_depth = -1, h.roulette_depth = 2, h.filter = "box",
    h.light_sampling = false, h.exposure = -1.1, h.tonemap = "filmic", h.build = "high", h.white_balance = 2856,
    h.filter_radius = 1.25, h.background = Color{0.25f, 0.5f, 0};
    const RenderHints r = saved(scene).hints;
    EXPECT_EQ(std::tie(r.width, r.height, r.samples, r.max_depth, r.roulette_depth, r.filter, r.light_sampling,
                       r.exposure, r.tonemap, r.build, r.white_balance, r.filter_radius, r.background),
              std::tie(h.width, h.height, h.samples, h.max_depth, h.roulette_depth, h.filter, h.light_sampling,
                       h.exposure, h.tonemap, h.build, h.white_balance, h.filter_radius, h.background));
}

TEST_F(Save, AxesOfCameras)
{
    for (const CameraKind kind : {CameraKind::perspective, CameraKind::orthographic}) {
        SceneDescription scene;
        Camera camera;
        camera.kind = kind, camera.fov_axis = FovAxis::diagonal, camera.fov_aspect = 1.5;
        scene.cameras = {camera};
        scene.nodes.emplace_back().camera = 0;
        scene.roots = {0};
        const Camera read = saved(scene).cameras.at(0);
        EXPECT_EQ(read.fov_axis, FovAxis::diagonal);
        EXPECT_EQ(read.fov_aspect, 1.5);
    }
}

// -------------------------------------------------------------------------------------- scenes that can't be saved

TEST_F(Save, ReportsWhatFilesCannotExpress)
{
    SceneDescription scene;
    scene.images.push_back({"unused", "unused.png", {}});
    scene.cameras.resize(1);
    scene.lights.resize(1);
    scene.hints.width = 5;
    Material bright;
    bright.name = "bright";
    bright.base_color.value = {2, 0.5f, 0.5f};
    scene.materials = {bright};
    const SceneDescription again = saved(scene);
    const std::string file = (folder_ / "out" / "scene.json").string() + ": ";
    std::set<std::string> messages;
    for (const auto& [message, count] : save_warnings_.counts()) messages.insert(message.substr(file.size()));
    EXPECT_EQ(messages, (std::set<std::string>{
                            "images that no texture uses are not written", "cameras that no node uses are not written",
                            "lights that no node uses are not written",
                            "an image width without a height, or a height without a width, is not written",
                            "color: 2 of 'bright' becomes 1, because files allow 0 to 1"}));
    EXPECT_EQ(again.materials[0].base_color.value, (Color{1, 0.5f, 0.5f}));
}

std::string error_of_saving(const SceneDescription& scene, const fs::path& file)
{
    Warnings warnings;
    try {
        save_scene(scene, file, warnings);
    } catch (const Error& e) {
        return e.what();
    }
    return "written";
}

TEST_F(Save, NeverOverwritesItsSources)
{
    SceneDescription scene;
    scene.meshes = {triangle()};
    scene.meshes[0].name = "a";
    add_shape(scene, MeshInstance{0});
    const SceneDescription again = saved(scene);
    const auto before = files_of(folder_);
    const std::string refusal = ": the scene was read from this file: choose another name";
    const fs::path file = folder_ / "out/scene.json";
    EXPECT_EQ(error_of_saving(again, file), file.string() + refusal);
    // A scene with another name whose mesh files would overwrite those of this one.
    fs::create_directory_symlink(folder_ / "out/scene-files", folder_ / "out/other-files");
    EXPECT_EQ(error_of_saving(again, folder_ / "out/other.json"),
              (folder_ / "out/other-files/mesh-0-a.ply").string() + refusal);
    fs::create_symlink(file, folder_ / "link.json");
    EXPECT_EQ(error_of_saving(again, folder_ / "link.json"), (folder_ / "link.json").string() + refusal);
    fs::remove(folder_ / "link.json"), fs::remove(folder_ / "out/other-files");
    EXPECT_EQ(files_of(folder_), before);
}

TEST_F(Save, WhatIsNoSceneIsNotWritten)
{
    SceneDescription scene;
    scene.file = "made";
    scene.roots = {3};
    EXPECT_EQ(error_of_saving(scene, target("out")), "made: roots[0]: there is no node 3, only 0");
    scene.roots = {0};
    scene.nodes.resize(220);
    for (int i = 0; i < 219; ++i) scene.nodes[std::size_t(i)].children = {i + 1};
    EXPECT_EQ(error_of_saving(scene, target("out")),
              target("out").string() + ": nodes are nested more than 200 deep, which no file allows");
    EXPECT_FALSE(fs::exists(target("out")));
    scene.nodes.resize(201);
    scene.nodes[200].children.clear();
    EXPECT_EQ(saved(scene).nodes.size(), 201u);
}

}  // namespace
}  // namespace fathom::test
