// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "formats/import_test_helpers.h"

namespace fathom::test {
namespace {

class FathomJson : public ImportTest {};

TEST_F(FathomJson, CornellBox)
{
    const SceneDescription scene = load_scene(FATHOM_SCENES "/cornell-box.json", {}, warnings_);
    EXPECT_TRUE(warnings_.empty());
    ASSERT_EQ(scene.materials.size(), 4u);
    EXPECT_EQ(scene.materials[1].name, "green");
    EXPECT_EQ(scene.materials[1].base_color.value, (Color{.12f, .45f, .15f}));
    EXPECT_EQ(scene.materials[3].kind, MaterialKind::none);
    EXPECT_EQ(scene.materials[3].emission.radiance.value, (Color{15, 15, 15}));
    EXPECT_FALSE(scene.materials[3].emission.two_sided);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_NEAR(scene.cameras[0].fov_y, 40 * std::numbers::pi / 180, 1e-15);
    EXPECT_EQ(scene.hints.width, 800);
    EXPECT_EQ(scene.hints.height, 600);
    EXPECT_EQ(scene.hints.max_depth, 50);
    EXPECT_EQ(scene.hints.filter, "box");
    EXPECT_EQ(scene.environment.kind, EnvironmentKind::none);
    ASSERT_EQ(scene.roots.size(), 9u);  // the camera, six rectangles and two boxes
    const Vec3d center{277.5, 277.5, 277.5};
    for (int root : scene.roots) {
        const Node& node = scene.nodes[root];
        if (node.shapes.empty()) continue;
        if (const auto* r = std::get_if<Rectangle>(&node.shapes[0].geometry)) {
            const Vec3d middle = r->corner + r->edge_u * .5 + r->edge_v * .5;
            EXPECT_GT(dot(cross(r->edge_u, r->edge_v), center - middle), 0) << node.name << " must face the room";
        }
    }
    const Bounds bounds = world_bounds(scene);
    EXPECT_EQ(bounds.min, (Vec3d{0, 0, 0}));
    EXPECT_EQ(bounds.max, (Vec3d{555, 555, 555}));
}

TEST_F(FathomJson, CornellBoxOfTriangles)
{
    const SceneDescription scene = load_scene(FATHOM_SCENES "/cornell-box-triangles.json", {}, warnings_);
    std::size_t triangles = 0;
    double light_area = 0;
    for (const Mesh& mesh : scene.meshes) {
        triangles += mesh.indices.size() / 3;
        if (mesh.indices.size() != 6) continue;
    }
    EXPECT_EQ(triangles, 36u);
    const Mesh& light = scene.meshes.back();
    for (std::size_t i = 0; i < light.indices.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            const Vec3f p = light.positions[light.indices[i + k]];
            return Vec3d{p.x, p.y, p.z};
        };
        const Vec3d n = cross(at(1) - at(0), at(2) - at(0));
        EXPECT_LT(n.y, 0) << "the lamp shines downwards";
        light_area += length(n) / 2;
    }
    EXPECT_EQ(light_area, 130 * 105);
}

TEST_F(FathomJson, AllScenesOfTheProjectLoad)
{
    int scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(FATHOM_SCENES)) {
        if (entry.path().extension() != ".json") continue;
        SCOPED_TRACE(entry.path().string());
        EXPECT_NO_THROW(load_scene(entry.path(), {}, warnings_));
        EXPECT_TRUE(warnings_.empty());
        ++scenes;
    }
    EXPECT_GE(scenes, 3);
}

Vec3d moved(const SceneDescription& scene, Vec3d p)
{
    return scene.nodes[scene.roots.at(0)].parent_from_node.point(p);
}

TEST_F(FathomJson, Transforms)
{
    const auto scene_with = [&](const std::string& transform) {
        return load("t.json", R"({"scene": [{"sphere": {}, "transform": )" + transform + "}]}");
    };
    expect_near(moved(scene_with(R"({"translate": [1, 2, 3]})"), {1, 1, 1}), {2, 3, 4});
    expect_near(moved(scene_with(R"({"scale": 2})"), {1, 2, 3}), {2, 4, 6});
    expect_near(moved(scene_with(R"({"scale": [1, -2, 3]})"), {1, 1, 1}), {1, -2, 3});
    expect_near(moved(scene_with(R"({"rotate": {"axis": [0, 0, 2], "angle_deg": 90}})"), {1, 0, 5}), {0, 1, 5});
    // In one object, scale is applied first, then rotation, then translation, in any order of keys.
    expect_near(moved(scene_with(R"({"translate": [10, 0, 0], "rotate": {"axis": [0, 0, 1], "angle_deg": 90},
                                     "scale": [2, 1, 1]})"),
                      {1, 0, 0}),
                {10, 2, 0});
    // Transforms in a list are applied in order, the first one first.
    expect_near(moved(scene_with(R"([{"translate": [1, 0, 0]}, {"scale": 3}])"), {1, 0, 0}), {6, 0, 0});
    expect_near(moved(scene_with(R"([{"scale": 3}, {"translate": [1, 0, 0]}])"), {1, 0, 0}), {4, 0, 0});
    expect_near(moved(scene_with(R"({"matrix": [[1, 2, 3, 4], [0, 1, 0, 5], [0, 0, 1, 6], [0, 0, 0, 1]]})"), {1, 1, 1}),
                {10, 6, 7});
}

TEST_F(FathomJson, NamedNodesAreInstances)
{
    const SceneDescription scene = load("i.json", R"({
        "materials": {"red": {"color": [1, 0, 0]}},
        "nodes": {"ball": {"sphere": {"radius": 2}, "material": "red"},
                  "pair": {"children": ["ball", {"instance": "ball", "transform": {"translate": [10, 0, 0]}}]}},
        "scene": ["pair", {"instance": "pair", "transform": {"translate": [0, 10, 0]}}]})");
    int spheres = 0;
    for (const Node& node : scene.nodes) spheres += int(node.shapes.size());
    EXPECT_EQ(spheres, 1);
    const Bounds bounds = world_bounds(scene);
    EXPECT_EQ(bounds.min, (Vec3d{-2, -2, -2}));
    EXPECT_EQ(bounds.max, (Vec3d{12, 12, 2}));
}

TEST_F(FathomJson, TexturesByNameAndUse)
{
    const SceneDescription scene = load("m.json", R"({
        "textures": {"wood": {"image": "wood.png", "wrap_u": "mirror", "uv_scale": [2, 3]},
                     "chess": {"kind": "checker_uv", "scale": 8, "color_a": 0.1}},
        "materials": {"a": {"kind": "principled", "color": "wood", "roughness": {"texture": "wood", "value": 0.5},
                            "normal_map": {"image": "n.png"}},
                      "b": {"color": {"value": 0.5, "texture": "chess"}}}})");
    ASSERT_EQ(scene.images.size(), 2u);
    EXPECT_EQ(scene.images[0].path, folder_ / "wood.png");
    const Material& a = scene.materials[0];
    EXPECT_EQ(scene.textures[a.base_color.texture].color_space, ColorSpace::srgb);
    EXPECT_EQ(scene.textures[a.base_color.texture].wrap_u, Wrap::mirror);
    EXPECT_EQ(scene.textures[a.roughness.texture].color_space, ColorSpace::linear);
    EXPECT_EQ(scene.textures[a.roughness.texture].image, scene.textures[a.base_color.texture].image);
    EXPECT_EQ(scene.textures[a.normal_map.texture].color_space, ColorSpace::linear);
    EXPECT_EQ(a.roughness.value, 0.5f);
    EXPECT_EQ(a.roughness.channel, 1);
    EXPECT_EQ(scene.textures[scene.materials[1].base_color.texture].kind, TextureKind::checker_uv);
}

TEST_F(FathomJson, Glass)
{
    const SceneDescription scene = load("s.json", R"({"materials": {
        "clear": {"kind": "glass"},
        "pane": {"kind": "glass", "thin": true, "color": [0.5, 1, 1]}}})");
    for (const Material& m : scene.materials) {
        const bool pane = m.name == "pane";
        EXPECT_EQ(m.kind, MaterialKind::glass);
        EXPECT_EQ(m.interior.thin, pane);
        EXPECT_EQ(m.transmission.color.value, (Color{pane ? 0.5f : 1.0f, 1, 1}));
    }
}

/// Each key of a camera has a distinct value.
TEST_F(FathomJson, EveryKeyOfACamera)
{
    const SceneDescription scene = load("c.json", R"({"cameras": {
        "a": {"position": [1, 2, 3], "look_at": [4, 5, 7], "up": [0.5, 1, 0.25], "fov_y_deg": 30, "aspect": 1.5, "aperture": 0.125,
              "focus_distance": 9, "shutter": [0.25, 0.75], "shift": [0.375, -0.625]},
        "b": {"kind": "orthographic", "height": 11, "shift": [2, 3]}}})");
    ASSERT_EQ(scene.cameras.size(), 2u);
    const Camera& a = scene.cameras[0];
    EXPECT_EQ(a.name, "a");
    EXPECT_EQ(a.kind, CameraKind::perspective);
    EXPECT_EQ(a.position, (Vec3d{1, 2, 3}));
    EXPECT_EQ(a.look_at, (Vec3d{4, 5, 7}));
    EXPECT_EQ(a.up, (Vec3d{0.5, 1, 0.25}));
    EXPECT_NEAR(a.fov_y, std::numbers::pi / 6, 1e-15);
    EXPECT_EQ(a.aspect, 1.5);
    EXPECT_EQ(a.aperture, 0.125);
    EXPECT_EQ(a.focus_distance, 9);
    EXPECT_EQ(a.shift_x, 0.375);
    EXPECT_EQ(a.shift_y, -0.625);
    EXPECT_EQ(scene.cameras[1].shift_y, 3);
    EXPECT_EQ(a.shutter_open, 0.25);
    EXPECT_EQ(a.shutter_close, 0.75);
    EXPECT_EQ(scene.cameras[1].kind, CameraKind::orthographic);
    EXPECT_EQ(scene.cameras[1].height, 11);
}

TEST_F(FathomJson, EveryKeyOfATexture)
{
    const SceneDescription scene = load("t.json", R"({"textures": {
        "a": {"image": "a.png", "color_space": "linear", "wrap_u": "clamp", "wrap_v": "mirror", "lookup": "nearest", "uv_set": 1,
              "uv_offset": [1, 2], "uv_scale": [3, 4], "uv_rotation_deg": 90},
        "b": {"kind": "marble", "color_a": [1, 2, 3], "color_b": [4, 5, 6], "scale": 7, "octaves": 3, "turbulence_weight": 8},
        "c": {"kind": "checker_uv", "uv_scale": [2, 5]}, "d": {"kind": "checker_space"}, "e": {"kind": "noise"},
        "f": {"kind": "turbulence", "octaves": 5},
        "g": {"kind": "fbm", "gain": 0.25, "octaves": 3, "scale": 2, "transform": {"translate": [1, 2, 3]}},
        "h": {"kind": "facing", "direction": [1, 2, 3]},
        "i": {"kind": "dots", "mapping": "cylindrical", "transform": {"scale": 2}},
        "j": {"image": "a.png", "mapping": "planar", "wrap_u": "black", "wrap_v": "octahedral"}}})");
    const auto texture = [&](const std::string& name) {
        for (const Texture& t : scene.textures)
            if (t.name == name) return t;
        ADD_FAILURE() << name;
        return Texture{};
    };
    const Texture a = texture("a"), b = texture("b");
    EXPECT_EQ(a.kind, TextureKind::image);
    EXPECT_EQ(a.color_space, ColorSpace::linear);
    EXPECT_EQ(a.wrap_u, Wrap::clamp);
    EXPECT_EQ(a.wrap_v, Wrap::mirror);
    EXPECT_TRUE(a.nearest);
    EXPECT_EQ(a.uv_set, 1);
    EXPECT_EQ(a.uv_offset.x, 1);
    EXPECT_EQ(a.uv_offset.y, 2);
    EXPECT_EQ(a.uv_scale.x, 3);
    EXPECT_EQ(a.uv_scale.y, 4);
    EXPECT_FLOAT_EQ(a.uv_rotation, float(std::numbers::pi / 2));
    EXPECT_EQ(b.kind, TextureKind::marble);
    EXPECT_EQ(b.color_a.value, (Color{1, 2, 3}));
    EXPECT_EQ(b.color_b.value, (Color{4, 5, 6}));
    EXPECT_EQ(b.scale, 7);
    EXPECT_EQ(b.octaves, 3);
    EXPECT_EQ(b.turbulence_weight, 8);
    EXPECT_EQ(texture("c").kind, TextureKind::checker_uv);
    EXPECT_EQ(texture("c").uv_scale.y, 5);
    EXPECT_EQ(texture("d").kind, TextureKind::checker_space);
    EXPECT_EQ(texture("e").kind, TextureKind::noise);
    EXPECT_EQ(texture("f").kind, TextureKind::turbulence);
    EXPECT_EQ(texture("f").octaves, 5);
    EXPECT_EQ(texture("g").kind, TextureKind::fbm);
    EXPECT_EQ(texture("g").gain, 0.25f);
    EXPECT_EQ(texture("g").world_from_texture.m, Transform::translate({1, 2, 3}).m);
    EXPECT_EQ(texture("h").direction, (Vec3d{1, 2, 3}));
    EXPECT_EQ(texture("i").kind, TextureKind::dots);
    EXPECT_EQ(texture("i").mapping, TextureMapping::cylindrical);
    EXPECT_EQ(texture("i").world_from_texture.m, Transform::scale({2, 2, 2}).m);
    EXPECT_EQ(texture("j").mapping, TextureMapping::planar);
    EXPECT_EQ(texture("j").wrap_u, Wrap::black);
    EXPECT_EQ(texture("j").wrap_v, Wrap::octahedral);
}

TEST_F(FathomJson, EveryKeyOfAMaterial)
{
    const SceneDescription scene = load("m.json", R"({"materials": {
        "a": {"kind": "principled", "color": [0.1, 0.2, 0.3], "roughness": {"texture": {"image": "r.png"}, "channel": "a"},
              "metallic": {"texture": {"image": "m.png"}, "channel": "r", "value": 0.5}, "ior": 1.25,
              "emission": [1, 2, 3], "emission_two_sided": true, "normal_map": {"image": "n.png"}, "normal_scale": 0.75,
              "alpha": {"texture": {"image": "a.png"}, "value": 0.25}, "alpha_mode": "mask", "alpha_cutoff": 0.125,
              "use_vertex_color": true},
        "b": {"kind": "glass", "color": [0.4, 0.5, 0.6], "ior": 2, "roughness": 0.5, "attenuation_color": [0.7, 0.8, 0.9],
              "attenuation_distance": 3},
        "c": {"kind": "fuzz_metal", "fuzz": 0.3}, "d": {"kind": "metal", "roughness": 0.6},
        "e": {"alpha": 0.5}, "f": {"kind": "none"}, "g": {"kind": "unlit", "color": [3, 2, 1]}}})");
    ASSERT_EQ(scene.materials.size(), 7u);
    const Material &a = scene.materials[0], &b = scene.materials[1];
    EXPECT_EQ(a.kind, MaterialKind::principled);
    EXPECT_EQ(a.base_color.value, (Color{0.1f, 0.2f, 0.3f}));
    EXPECT_EQ(scene.images[std::size_t(scene.textures[std::size_t(a.roughness.texture)].image)].name, "r.png");
    EXPECT_EQ(a.roughness.channel, 3);
    EXPECT_EQ(a.roughness.value, 1);
    EXPECT_EQ(scene.images[std::size_t(scene.textures[std::size_t(a.metallic.texture)].image)].name, "m.png");
    EXPECT_EQ(a.metallic.channel, 0);
    EXPECT_EQ(a.metallic.value, 0.5f);
    EXPECT_EQ(a.ior, 1.25f);
    EXPECT_EQ(a.emission.radiance.value, (Color{1, 2, 3}));
    EXPECT_TRUE(a.emission.two_sided);
    EXPECT_EQ(scene.images[std::size_t(scene.textures[std::size_t(a.normal_map.texture)].image)].name, "n.png");
    EXPECT_EQ(a.normal_map.scale, 0.75f);
    EXPECT_EQ(scene.images[std::size_t(scene.textures[std::size_t(a.opacity.alpha.texture)].image)].name, "a.png");
    EXPECT_EQ(a.opacity.alpha.value, 0.25f);
    EXPECT_EQ(a.opacity.alpha.channel, 3);
    EXPECT_EQ(a.opacity.mode, AlphaMode::mask);
    EXPECT_EQ(a.opacity.cutoff, 0.125f);
    EXPECT_TRUE(a.use_vertex_color);
    EXPECT_EQ(b.transmission.color.value, (Color{0.4f, 0.5f, 0.6f}));
    EXPECT_EQ(b.ior, 2);
    EXPECT_EQ(b.roughness.value, 0.5f);
    EXPECT_EQ(b.interior.attenuation_color, (Color{0.7f, 0.8f, 0.9f}));
    EXPECT_EQ(b.interior.attenuation_distance, 3);
    EXPECT_EQ(scene.materials[2].fuzz, 0.3f);
    EXPECT_EQ(scene.materials[3].kind, MaterialKind::metal);
    EXPECT_EQ(scene.materials[3].roughness.value, 0.6f);
    EXPECT_EQ(scene.materials[4].opacity.mode, AlphaMode::blend);
    EXPECT_EQ(scene.materials[4].kind, MaterialKind::diffuse);
    EXPECT_EQ(scene.materials[5].kind, MaterialKind::none);
    EXPECT_EQ(scene.materials[6].base_color.value, (Color{3, 2, 1}));
}

TEST_F(FathomJson, EveryKeyOfShapesLightsAndSurroundings)
{
    const SceneDescription scene = load("s.json", R"({
        "environment": {"kind": "image", "image": "sky.hdr", "color": [1, 2, 3], "illuminance": 500, "rotate": {"axis": [1, 0, 0], "angle_deg": 90}},
        "render": {"size": [3, 4], "samples": 5, "max_depth": 6, "roulette_depth": 7, "filter": "gaussian", "filter_radius": 1.5, "build": "high",
                   "light_sampling": false, "exposure": -1.5, "white_balance": 3200, "tonemap": "filmic"},
        "lights": {"spot": {"kind": "spot", "position": [1, 2, 3], "direction": [0, 0, 1], "inner_angle_deg": 30, "outer_angle_deg": 60}},
        "scene": [{"sphere": {"center": [1, 2, 3], "radius": -4, "center_end": [5, 6, 7]}},
                  {"rectangle": {"corner": [1, 2, 3], "edge_u": [4, 5, 6], "edge_v": [7, 8, 10]}},
                  {"box": {"min": [1, 2, 3], "max": [4, 6, 8]}}, {"disk": {"center": [1, 2, 3], "normal": [4, 5, 6], "radius": 7}},
                  {"mesh": {"positions": [[1, 2, 3], [4, 5, 6], [7, 8, 10]], "normals": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
                            "tangents": [[1, 0, 0, 1], [0, 1, 0, -1], [0, 0, 1, 1]], "uvs": [[1, 2], [3, 4], [5, 6]],
                            "uvs_1": [[7, 8], [9, 10], [11, 12]], "colors": [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]],
                            "indices": [[2, 0, 1]]}}]})");
    const auto& hints = scene.hints;
    EXPECT_EQ(hints.width, 3);
    EXPECT_EQ(hints.height, 4);
    EXPECT_EQ(hints.samples, 5);
    EXPECT_EQ(hints.max_depth, 6);
    EXPECT_EQ(hints.roulette_depth, 7);
    EXPECT_EQ(hints.filter, "gaussian");
    EXPECT_EQ(hints.filter_radius, 1.5);
    EXPECT_EQ(hints.build, "high");
    EXPECT_EQ(hints.light_sampling, false);
    EXPECT_EQ(hints.exposure, -1.5);
    EXPECT_EQ(hints.white_balance, 3200);
    EXPECT_EQ(hints.tonemap, "filmic");
    EXPECT_EQ(scene.environment.color, (Color{1, 2, 3}));
    EXPECT_EQ(scene.environment.illuminance, 500);
    expect_near(scene.environment.world_from_environment.vector({0, 1, 0}), {0, 0, 1});
    EXPECT_NEAR(scene.lights[0].inner_angle, std::numbers::pi / 6, 1e-15);
    EXPECT_NEAR(scene.lights[0].outer_angle, std::numbers::pi / 3, 1e-15);
    std::vector<const Shape*> shapes;
    for (int root : scene.roots)
        for (const Shape& shape : scene.nodes[std::size_t(root)].shapes) shapes.push_back(&shape);
    ASSERT_EQ(shapes.size(), 5u);
    const auto& sphere = std::get<Sphere>(shapes[0]->geometry);
    EXPECT_EQ(sphere.center, (Vec3d{1, 2, 3}));
    EXPECT_EQ(sphere.radius, -4);
    ASSERT_TRUE(sphere.center_end);
    EXPECT_EQ(*sphere.center_end, (Vec3d{5, 6, 7}));
    const auto& rectangle = std::get<Rectangle>(shapes[1]->geometry);
    EXPECT_EQ(rectangle.corner, (Vec3d{1, 2, 3}));
    EXPECT_EQ(rectangle.edge_u, (Vec3d{4, 5, 6}));
    EXPECT_EQ(rectangle.edge_v, (Vec3d{7, 8, 10}));
    const auto& box = std::get<Box>(shapes[2]->geometry);
    EXPECT_EQ(box.min, (Vec3d{1, 2, 3}));
    EXPECT_EQ(box.max, (Vec3d{4, 6, 8}));
    const auto& disk = std::get<Disk>(shapes[3]->geometry);
    EXPECT_EQ(disk.center, (Vec3d{1, 2, 3}));
    EXPECT_EQ(disk.normal, (Vec3d{4, 5, 6}));
    EXPECT_EQ(disk.radius, 7);
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.positions[1].z, 6);
    EXPECT_EQ(mesh.normals[1].y, 1);
    EXPECT_EQ(mesh.tangents[1].w, -1);
    EXPECT_EQ(mesh.uvs[0][2].x, 5);
    EXPECT_EQ(mesh.uvs[1][2].y, 12);
    EXPECT_EQ(mesh.colors[1].w, 8);
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{2, 0, 1}));
    // The spot light's position and direction are the given ones.
    for (int root : scene.roots)
        if (const Node& node = scene.nodes[std::size_t(root)]; node.light >= 0) {
            expect_near(node.parent_from_node.point({0, 0, -1}), {1, 2, 4});
        }
}

TEST_F(FathomJson, SkyAndSun)
{
    const SceneDescription usual = load("s.json", R"({"environment": {"kind": "sky"}, "scene": []})");
    EXPECT_EQ(usual.environment.kind, EnvironmentKind::sky);
    EXPECT_TRUE(usual.environment.sun_disk);
    const SceneDescription other = load("t.json", R"({"environment": {"kind": "sky", "to_sun": [1, 2, 3], "sun": false,
        "color": 5, "rotate": {"axis": [0, 1, 0], "angle_deg": 90}}, "scene": []})");
    EXPECT_EQ(other.environment.to_sun, (Vec3d{1, 2, 3}));
    EXPECT_FALSE(other.environment.sun_disk);
    EXPECT_EQ(other.environment.color, (Color{5, 5, 5}));
    EXPECT_NEAR(other.environment.world_from_environment.vector({1, 0, 0}).z, -1, 1e-12);
}

TEST_F(FathomJson, UnitsOfLight)
{
    const SceneDescription scene = load("l.json", R"({
        "materials": {"nits": {"emission": 2}, "watts": {"emission": [1, 0, 0], "emission_unit": "W/m2"}},
        "lights": {"cd": {"kind": "point", "intensity": 5}, "lm": {"kind": "point", "intensity": 100, "unit": "lm"},
                   "W": {"kind": "spot", "intensity": 2, "unit": "W", "color": [1, 0.5, 0]},
                   "sun": {"kind": "directional", "intensity": 1000, "direction": [0, -3, 0], "angle_deg": 0.5}}})");
    constexpr double pi = std::numbers::pi;
    EXPECT_EQ(scene.materials[0].emission.radiance.value.r, 2);
    EXPECT_NEAR(scene.materials[1].emission.radiance.value.r, 683 / pi, 1e-4);
    EXPECT_EQ(scene.lights[0].intensity.g, 5);
    EXPECT_NEAR(scene.lights[1].intensity.g, 100 / (4 * pi), 1e-5);
    EXPECT_NEAR(scene.lights[2].intensity.g, 0.5 * 2 * 683 / (4 * pi), 1e-4);
    EXPECT_EQ(scene.lights[3].intensity.r, 1000);
    EXPECT_NEAR(scene.lights[3].angle, 0.5 * pi / 180, 1e-12);
    expect_near(scene.nodes[scene.roots[3]].parent_from_node.vector({0, 0, -1}), {0, -1, 0});
    EXPECT_NEAR(scene.nodes[scene.roots[3]].parent_from_node.determinant(), 1, 1e-12);
}

TEST_F(FathomJson, LightsWithPictures)
{
    const SceneDescription scene = load("l.json", R"({"lights": {
        "a": {"kind": "projector", "image": "p.png", "color_space": "linear", "lookup": "nearest", "fov_deg": 30, "fov_axis": "height",
              "flat_field": true, "intensity": 800, "unit": "lm", "direction": [0, -1, 0], "up": [1, 0, 0]},
        "b": {"kind": "goniometric", "image": "lamp.ies", "intensity": 2, "position": [1, 2, 3]},
        "c": {"kind": "spot", "image": "p.png", "falloff": "smooth", "intensity": 12.566370614, "unit": "lm"}, "d": {"kind": "projector", "unit": "W"}}})");
    ASSERT_EQ(scene.lights.size(), 4u);
    const Light& a = scene.lights[0];
    EXPECT_EQ(a.kind, LightKind::projector);
    EXPECT_EQ(scene.images.at(std::size_t(a.picture.image)).name, "p.png");
    EXPECT_EQ(a.picture.color_space, ColorSpace::linear);
    EXPECT_TRUE(a.picture.nearest);
    EXPECT_NEAR(a.fov, std::numbers::pi / 6, 1e-12);
    EXPECT_EQ(a.fov_axis, FovAxis::height);
    EXPECT_TRUE(a.flat_field);
    EXPECT_TRUE(a.intensity_is_flux);
    EXPECT_EQ(a.intensity.g, 800);
    const Transform& t = scene.nodes.at(std::size_t(scene.roots[0])).parent_from_node;
    expect_near(t.vector({0, 0, -1}), {0, -1, 0});
    expect_near(t.vector({0, 1, 0}), {1, 0, 0});
    EXPECT_NEAR(t.determinant(), 1, 1e-12);
    EXPECT_EQ(scene.lights[1].kind, LightKind::goniometric);
    EXPECT_FALSE(scene.lights[1].intensity_is_flux);
    EXPECT_EQ(scene.lights[1].intensity.g, 2);
    EXPECT_EQ(scene.images.at(std::size_t(scene.lights[1].picture.image)).name, "lamp.ies");
    EXPECT_EQ(scene.lights[2].picture.image, a.picture.image);
    EXPECT_EQ(scene.lights[2].falloff, SpotFalloff::smooth);
    EXPECT_NEAR(scene.lights[2].intensity.g, 1, 1e-6);
    EXPECT_FALSE(scene.lights[2].intensity_is_flux);
    EXPECT_EQ(scene.lights[3].picture.image, -1);
    EXPECT_EQ(scene.lights[3].intensity.g, 683);

    const auto error = [&](const std::string& light) {
        return error_of("e.json", R"({"lights": {"l": {)" + light + "}}}");
    };
    EXPECT_EQ(error(R"("kind": "goniometric")"), "/lights/l: key 'image' is missing");
    EXPECT_NE(error(R"("kind": "projector", "fov_deg": 180)").find("fov_deg"), std::string::npos);
    EXPECT_NE(error(R"("kind": "projector", "up": [0, 0, 2])").find("/lights/l/up"), std::string::npos);
    EXPECT_NE(error(R"("kind": "point", "image": "a.png")").find("image"), std::string::npos);
    EXPECT_NE(error(R"("kind": "spot", "fov_deg": 20)").find("fov_deg"), std::string::npos);
    EXPECT_NE(error(R"("kind": "spot", "up": [1, 0, 0])").find("up"), std::string::npos);
}

/// Conductors by name or by index of refraction are equal; `metal` has no edge color of its own.
TEST_F(FathomJson, Conductors)
{
    const SceneDescription scene = load("l.json", R"({"materials": {
        "a": {"kind": "principled", "conductor": "gold", "roughness": 0.25},
        "b": {"kind": "principled",
              "conductor": {"eta": [0.18299, 0.42108, 1.3734], "k": [3.4242, 2.3459, 1.7704]}},
        "c": {"kind": "metal", "conductor": "gold"}}})");
    const auto& m = scene.materials;
    EXPECT_EQ(m[0].metallic.value, 1);
    EXPECT_EQ(m[0].roughness.value, 0.25f);
    // Reflectance at normal incidence is ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2).
    EXPECT_NEAR(m[0].base_color.value.r, 0.9442f, 1e-4f);
    EXPECT_NEAR(m[0].base_color.value.g, 0.7761f, 1e-4f);
    EXPECT_NEAR(m[0].base_color.value.b, 0.3734f, 1e-4f);
    EXPECT_LT(m[0].conductor.edge_color.value.r, 1);
    EXPECT_EQ(m[1].base_color.value, m[0].base_color.value);
    EXPECT_EQ(m[1].conductor.edge_color.value, m[0].conductor.edge_color.value);
    EXPECT_EQ(m[2].base_color.value, m[0].base_color.value);
    EXPECT_EQ(m[0].conductor.eta, (Color{0.18299f, 0.42108f, 1.3734f}));
    EXPECT_EQ(m[1].conductor.k, m[0].conductor.k);
}

TEST_F(FathomJson, ModelsAreReadOnceAndTheirMaterialsReplaced)
{
    write("part.json", R"({"materials": {"a": {"color": [1, 0, 0]}, "b": {"color": [0, 1, 0]}},
        "meshes": {"m": {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}},
        "scene": [{"mesh": "m", "material": "a"}, {"mesh": "m", "material": "b"}]})");
    const SceneDescription scene = load("s.json", R"({"materials": {"c": {"kind": "glass"}},
        "scene": [{"model": "part.json"}, {"model": "part.json", "material": "c"},
                  {"model": "part.json", "materials": {"b": "c"}}]})");
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.materials.size(), 3u);
    const auto material = [&](int root, int child) {
        const Node& node = scene.nodes[scene.roots[root]];
        return scene.materials[scene.nodes[node.children[child]].shapes.at(0).material].name;
    };
    EXPECT_EQ(material(0, 0), "a");
    EXPECT_EQ(material(0, 1), "b");
    EXPECT_EQ(material(1, 0), "c");
    EXPECT_EQ(material(1, 1), "c");
    EXPECT_EQ(material(2, 0), "a");
    EXPECT_EQ(material(2, 1), "c");
}

TEST_F(FathomJson, LightsAndCamerasStandWhereNodesReferToThem)
{
    const SceneDescription scene = load("a.json", R"({
        "cameras": {"free": {}, "held": {"look_at": [1, 0, 0]}},
        "lights": {"bulb": {"kind": "point", "position": [1, 2, 3]}, "lamp": {"kind": "spot"}, "sun": {"kind": "directional"}},
        "scene": [{"name": "a", "camera": "held", "light": "lamp"}, {"name": "b", "light": "lamp"}]})");
    ASSERT_EQ(scene.roots.size(), 5u);
    const auto root = [&](int i) { return scene.nodes.at(std::size_t(scene.roots.at(std::size_t(i)))); };
    EXPECT_EQ(scene.cameras.at(std::size_t(root(0).camera)).name, "held");
    EXPECT_EQ(scene.lights.at(std::size_t(root(0).light)).name, "lamp");
    EXPECT_EQ(root(1).light, root(0).light);
    // Cameras and lights without a node become root nodes.
    EXPECT_EQ(scene.cameras.at(std::size_t(root(2).camera)).name, "free");
    EXPECT_EQ(scene.lights.at(std::size_t(root(3).light)).name, "bulb");
    expect_near(root(3).parent_from_node.point({0, 0, 0}), {1, 2, 3});
    EXPECT_EQ(scene.lights.at(std::size_t(root(4).light)).name, "sun");
    EXPECT_EQ(error_of("b.json", R"({"cameras": {"a": {}}, "scene": [{"camera": "b"}]})"),
              "/scene/0/camera: there is no camera named 'b'; known here: a");
    EXPECT_EQ(error_of("c.json", R"({"scene": [{"light": "b"}]})"), "/scene/0/light: there is no light named 'b'");
}

/// An image with an explicit color space is decoded once for all uses, otherwise once for each color space.
TEST_F(FathomJson, TexturesOfTwoUses)
{
    const auto count = [&](const std::string& texture) {
        return load("a.json", R"({"textures": {"t": {)" + texture + R"(}, "by": {"kind": "scale", "input": "t"}},
            "materials": {"m": {"kind": "principled", "color": "by", "roughness": "by"}}})")
            .textures.size();
    };
    EXPECT_EQ(count(R"("image": "a.png", "color_space": "srgb")"), 2u);
    EXPECT_EQ(count(R"("kind": "noise")"), 2u);
    EXPECT_EQ(count(R"("image": "a.png")"), 4u);
    EXPECT_EQ(error_of("b.json", R"({"textures": {"t": {"kind": "scale", "input": "t"}}})"),
              "/textures/t/input: texture 't' contains itself");
    EXPECT_EQ(error_of("c.json",
                       R"({"textures": {"t": {"kind": "scale", "input": "t", "by": {"texture": {"image": "a"}}}}})"),
              "/textures/t/input: texture 't' contains itself");
    EXPECT_EQ(error_of("d.json",
                       R"({"textures": {"a": {"kind": "scale", "input": "b"}, "b": {"kind": "scale", "input": "a"}}})"),
              "textures[0]: textures are nested more than 16 deep, or one contains itself");
    EXPECT_EQ(error_of("e.json", R"({"materials": {"a": {"kind": "two_sided", "front": "b", "back": "b"},
                                                   "b": {"kind": "mix", "material_a": "a", "material_b": "a"}}})"),
              "materials[0]: materials are mixed more than 16 deep, or one contains itself");
    EXPECT_EQ(error_of("f.json", R"({"materials": {"a": {"kind": "two_sided", "front": "b", "back": "a"}}})"),
              "/materials/a/front: there is no material named 'b'; known here: a");
    EXPECT_EQ(error_of("g.json", R"({"materials": {"a": {"kind": "mix", "material_a": {}}}})"),
              "/materials/a: key 'material_b' is missing");
}

TEST_F(FathomJson, FilesOfNumbers)
{
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float radius\nproperty float u1\nproperty float v1\nproperty float tw\n";
    const std::string rows = "0 0 0 1 0.1 0.2 1\n1 0 0 2 0.3 0.4 -1\n0 1 0 3 0.5 0.6 1\n0 0 1 4 0.7 0.8 1\n";
    write("a.ply", ply + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + rows + "3 0 1 2\n");
    write("b.ply", ply + "element curve 2\nproperty uint vertices\nend_header\n" + rows + "2\n2\n");
    const SceneDescription scene = load("a.json", R"({
        "curves": {"wires": {"basis": "linear", "file": "b.ply"}}, "points": {"balls": {"file": "b.ply"}},
        "meshes": {"m": {"file": "a.ply", "motion": [{"time": 0, "file": "b.ply"}, {"time": 1}]}},
        "scene": [{"mesh": "m"}, {"curves": "wires"}, {"curves": "wires"}, {"points": "balls"}]})");
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.name, "m");
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_TRUE(mesh.uvs[0].empty());
    EXPECT_EQ(mesh.uvs[1].at(1).y, 0.4f);
    EXPECT_EQ(mesh.tangents.at(1).w, -1);
    EXPECT_EQ(mesh.motion.at(0).positions.at(3).z, 1);
    EXPECT_EQ(scene.curves.size(), 1u);
    EXPECT_EQ(scene.curves[0].counts, (std::vector<std::uint32_t>{2, 2}));
    EXPECT_EQ(scene.curves[0].radii, (std::vector<float>{1, 2, 3, 4}));
    EXPECT_EQ(scene.points.at(0).radii.at(3), 4);
    EXPECT_EQ(scene.files.size(), 5u);  // the scene and one file for each use

    EXPECT_EQ(error_of("b.json", R"({"meshes": {"m": {"file": "a.ply", "positions": []}}})"),
              "/meshes/m/positions: unknown key 'positions' in a mesh; known here: file, motion");
    EXPECT_EQ(error_of("c.json", R"({"points": {"p": {"file": ""}}})"), "/points/p/file: the path of a file is empty");
    write("c.ply", ply + "element curve 1\nproperty uint vertices\nend_header\n" + rows + "5\n");
    EXPECT_THROW(load("d.json", R"({"curves": {"c": {"file": "c.ply"}}})"), Error);
    EXPECT_THROW(load("e.json", R"({"curves": {"c": {"file": "a.ply"}}})"), Error);  // the counts are missing
}

TEST_F(FathomJson, MatricesMayFlattenWhereTheySaySo)
{
    const SceneDescription scene = load("a.json", R"({"environment": {"kind": "gradient",
        "rotate": {"matrix": [[0, 0, 1, 0], [0, 1, 0, 0], [-1, 0, 0, 0]]}},
        "scene": [{"sphere": {}, "transform": {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]], "flat": true}}]})");
    expect_near(scene.environment.world_from_environment.vector({1, 0, 0}), {0, 0, -1});
    EXPECT_EQ(scene.nodes.at(0).parent_from_node.determinant(), 0);
}

}  // namespace
}  // namespace fathom::test
