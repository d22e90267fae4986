#include <numbers>

#include "import_test_helpers.h"

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
    EXPECT_EQ(scene.materials[3].emission.value, (Color{15, 15, 15}));
    EXPECT_FALSE(scene.materials[3].emission_two_sided);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_NEAR(scene.cameras[0].fov_y, 40 * std::numbers::pi / 180, 1e-15);
    EXPECT_EQ(scene.hints.width, 800);
    EXPECT_EQ(scene.hints.height, 600);
    EXPECT_EQ(scene.hints.max_depth, 50);
    EXPECT_EQ(scene.hints.filter, "box");
    EXPECT_EQ(scene.environment.kind, EnvironmentKind::none);
    ASSERT_EQ(scene.roots.size(), 9u);  // the camera, six rectangles, two boxes
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
    // In one object: scale, then rotate, then translate, whatever their order in the file.
    expect_near(moved(scene_with(R"({"translate": [10, 0, 0], "rotate": {"axis": [0, 0, 1], "angle_deg": 90},
                                     "scale": [2, 1, 1]})"),
                      {1, 0, 0}),
                {10, 2, 0});
    // In a list: the first is done first.
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
    EXPECT_EQ(scene.textures[a.normal_texture].color_space, ColorSpace::linear);
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
        EXPECT_EQ(m.thin, pane);
        EXPECT_EQ(m.transmission_color.value, (Color{pane ? 0.5f : 1.0f, 1, 1}));
    }
}

TEST_F(FathomJson, UnitsOfLight)
{
    const SceneDescription scene = load("l.json", R"({
        "materials": {"nits": {"emission": 2}, "watts": {"emission": [1, 0, 0], "emission_unit": "W/m2"}},
        "lights": {"cd": {"kind": "point", "intensity": 5}, "lm": {"kind": "point", "intensity": 100, "unit": "lm"},
                   "W": {"kind": "spot", "intensity": 2, "unit": "W", "color": [1, 0.5, 0]},
                   "sun": {"kind": "directional", "intensity": 1000, "direction": [0, -3, 0], "angle_deg": 0.5}}})");
    constexpr double pi = std::numbers::pi;
    EXPECT_EQ(scene.materials[0].emission.value.r, 2);
    EXPECT_NEAR(scene.materials[1].emission.value.r, 683 / pi, 1e-4);
    EXPECT_EQ(scene.lights[0].intensity.g, 5);
    EXPECT_NEAR(scene.lights[1].intensity.g, 100 / (4 * pi), 1e-5);
    EXPECT_NEAR(scene.lights[2].intensity.g, 0.5 * 2 * 683 / (4 * pi), 1e-4);
    EXPECT_EQ(scene.lights[3].intensity.r, 1000);
    EXPECT_NEAR(scene.lights[3].angle, 0.5 * pi / 180, 1e-12);
    expect_near(scene.nodes[scene.roots[3]].parent_from_node.vector({0, 0, -1}), {0, -1, 0});
    EXPECT_NEAR(scene.nodes[scene.roots[3]].parent_from_node.determinant(), 1, 1e-12);
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

}  // namespace
}  // namespace fathom::test
