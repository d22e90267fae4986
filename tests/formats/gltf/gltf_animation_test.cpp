// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "fathom/scene_file.h"
#include "formats/import_test_helpers.h"
#include "gltf_builder.h"

namespace fathom::test {
namespace {

class GltfAnimation : public ImportTest {
protected:
    SceneFileContents read(const std::string& gltf) { return load_scene_file(write("a.gltf", gltf), {}, warnings_); }
    /// Returns the scene at a time of its first animation.
    SceneDescription at(double time_s, const std::string& gltf)
    {
        SceneFileContents file = read(gltf);
        const AnimationPlayer player(file.scene, file.rig, 0);
        set_pose(file.scene, player.pose(time_s));
        return file.scene;
    }
    /// One animation whose channels have a sampler each, given as "input, output" and the target.
    static std::string animation(const std::vector<std::pair<std::string, std::string>>& channels)
    {
        std::vector<std::string> samplers, targets;
        for (const auto& [sampler, target] : channels) {
            targets.push_back(fmt::format(R"({{"sampler": {}, "target": {}}})", samplers.size(), target));
            samplers.push_back("{" + sampler + "}");
        }
        return fmt::format(R"("animations": [{{"name": "move", "samplers": [{}], "channels": [{}]}}])",
                           fmt::join(samplers, ", "), fmt::join(targets, ", "));
    }
    static std::string sampler(int input, int output, const std::string& interpolation = "LINEAR")
    {
        return fmt::format(R"("input": {}, "output": {}, "interpolation": "{}")", input, output, interpolation);
    }
    static std::string node(int index, const char* path)
    {
        return fmt::format(R"({{"node": {}, "path": "{}"}})", index, path);
    }
    static std::string pointer(const std::string& to)
    {
        return fmt::format(R"({{"path": "pointer", "extensions": {{"KHR_animation_pointer": {{"pointer": "{}"}}}}}})",
                           to);
    }
    std::string warning()
    {
        std::string all;
        for (const auto& [message, count] : warnings_.counts()) all += message.substr(message.find(": ") + 2) + "\n";
        return all;
    }
};

/// Keys may be floats, normalized shorts or bytes, or sparse accessors.
TEST_F(GltfAnimation, NodesMove)
{
    GltfBuilder b;
    const int mesh = b.triangle(), times = b.floats({0, 2}, "SCALAR");
    const int translation =
        b.accessor(-1, 5126, 2, "VEC3",
                   fmt::format(R"("sparse": {{"count": 1, "indices": {{"bufferView": {}, "componentType": 5121}},
                                                    "values": {{"bufferView": {}}}}})",
                               b.view<std::uint8_t>({1}), b.view<float>({4, 0, 0})));
    const int rotation = b.accessor(b.view<std::int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170}), 5122, 2, "VEC4",
                                    R"("normalized": true)");
    const int scale = b.floats({1, 1, 1, 1, 3, 1}, "VEC3");
    const std::string gltf =
        b.gltf(fmt::format(R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0, "translation": [0, 0, 7]}}],
                       "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}}}]}}], {})",
                           mesh,
                           animation({{sampler(times, translation), node(0, "translation")},
                                      {sampler(times, rotation), node(0, "rotation")},
                                      {sampler(times, scale, "STEP"), node(0, "scale")}})));
    const SceneFileContents file = read(gltf);
    ASSERT_EQ(file.rig.animations.size(), 1u);
    EXPECT_EQ(file.rig.animations[0].name, "move");
    EXPECT_EQ(file.rig.animations[0].duration(), 2);
    EXPECT_TRUE(warnings_.empty()) << warning();
    // The rest pose equals the file without its animation.
    EXPECT_EQ(file.scene.nodes[0].parent_from_node.m, Transform::translate({0, 0, 7}).m);
    EXPECT_FALSE(file.scene.nodes[0].movable);
    for (const double t : {0.0, 0.5, 1.5, 2.0, 3.0}) {
        const double u = std::min(t / 2, 1.0);
        const Transform expected = Transform::translate({4 * u, 0, 0}) * Transform::rotate({0, 0, 1}, u * M_PI / 2) *
                                   Transform::scale({1, u < 1 ? 1.0 : 3.0, 1});
        const Transform got = at(t, gltf).nodes[0].parent_from_node;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(got.m[i][k], expected.m[i][k], 1e-4) << t;
    }
}

/// Two nodes share a mesh and one of them is animated: the other keeps its shape.
TEST_F(GltfAnimation, WeightsMorphTheirNodeAlone)
{
    GltfBuilder b;
    const int mesh = b.triangle(), normals = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int up = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3"), aside = b.floats({8, 0, 0, 8, 0, 0, 8, 0, 0}, "VEC3");
    const int tilt = b.floats({1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
    const int times = b.floats({0, 1}, "SCALAR"), weights = b.floats({0, 0, 1, 0.5}, "SCALAR");
    const std::string rest = fmt::format(
        R"("scenes": [{{"nodes": [0, 1]}}], "nodes": [{{"mesh": 0}}, {{"mesh": 0}}], "meshes": [{{"weights": [0.25, 0],
           "primitives": [{{"attributes": {{"POSITION": {}, "NORMAL": {}}},
           "targets": [{{"POSITION": {}, "NORMAL": {}}}, {{"POSITION": {}}}]}}]}}])",
        mesh, normals, up, tilt, aside);
    const std::string gltf = b.gltf(rest + ", " + animation({{sampler(times, weights), node(0, "weights")}}));
    const SceneDescription without = load("b.gltf", b.gltf(rest));
    const auto mesh_of = [](const SceneDescription& scene, std::size_t i) {
        return scene.meshes[std::size_t(std::get<MeshInstance>(scene.nodes[i].shapes.at(0).geometry).mesh)];
    };
    const SceneFileContents file = read(gltf);
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_EQ(mesh_of(file.scene, i).positions[1].z, mesh_of(without, i).positions[1].z);
    const SceneDescription posed = at(0.5, gltf);
    EXPECT_FLOAT_EQ(mesh_of(posed, 0).positions[1].z, 0.5f);
    EXPECT_FLOAT_EQ(mesh_of(posed, 0).positions[1].x, 1 + 8 * 0.25f);
    EXPECT_FLOAT_EQ(mesh_of(posed, 0).normals[1].x, 0.5f);
    EXPECT_TRUE(mesh_of(posed, 0).movable);
    EXPECT_FLOAT_EQ(mesh_of(posed, 1).positions[1].z, 0.25f);
    EXPECT_FALSE(mesh_of(posed, 1).movable);
}

TEST_F(GltfAnimation, SkinsFollowTheirJoints)
{
    GltfBuilder b;
    const int positions = b.triangle(), times = b.floats({0, 1}, "SCALAR");
    const int joints = b.accessor(b.view<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}), 5121, 3, "VEC4");
    const int weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0}, "VEC4");
    const int places = b.floats({0, 0, 0, 0, 0, 6}, "VEC3");
    const std::string gltf = b.gltf(fmt::format(
        R"("scenes": [{{"nodes": [0, 1]}}], "skins": [{{"joints": [1, 2]}}],
           "nodes": [{{"mesh": 0, "skin": 0}}, {{"children": [2]}}, {{}}],
           "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}, "JOINTS_0": {}, "WEIGHTS_0": {}}}}}]}}], {})",
        positions, joints, weights, animation({{sampler(times, places), node(2, "translation")}})));
    const SceneDescription scene = at(0.5, gltf);
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_TRUE(scene.meshes[0].movable);
    EXPECT_EQ(scene.meshes[0].positions[0].z, 0);
    EXPECT_EQ(scene.meshes[0].positions[1].z, 3);
    EXPECT_EQ(scene.meshes[0].positions[2].z, 1.5f);
    EXPECT_EQ(world_bounds(scene).max, (Vec3d{1, 1, 3}));
    // The scene's bounds, which frame the camera, include all poses.
    SceneFileContents file = read(gltf);
    const AnimationPlayer player(file.scene, file.rig, 0);
    EXPECT_EQ(world_bounds(file.scene, player).max, (Vec3d{1, 1, 6}));
}

/// All sets of joints are used like the first one, at rest and in other poses.
TEST_F(GltfAnimation, SkinsOfManyJoints)
{
    GltfBuilder b;
    const int positions = b.triangle(), times = b.floats({0, 1}, "SCALAR");
    const auto joints = [&](const std::vector<std::uint8_t>& each) {
        return b.accessor(b.view(each), 5121, 3, "VEC4");
    };
    // The second vertex has equal weights on five nodes.
    const int first = joints({0, 0, 0, 0, 0, 1, 2, 3, 0, 0, 0, 0}),
              second = joints({0, 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0});
    const int weights = b.floats({1, 0, 0, 0, 0.2f, 0.2f, 0.2f, 0.2f, 1, 0, 0, 0}, "VEC4");
    const int more = b.floats({0, 0, 0, 0, 0.2f, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    const int places = b.floats({0, 0, 10, 0, 0, 30}, "VEC3");
    const std::string gltf = b.gltf(fmt::format(
        R"("scenes": [{{"nodes": [0, 1, 2, 3, 4, 5]}}], "skins": [{{"joints": [1, 2, 3, 4, 5]}}],
           "nodes": [{{"mesh": 0, "skin": 0}}, {{}}, {{}}, {{}}, {{}}, {{"translation": [0, 0, 10]}}],
           "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}, "JOINTS_0": {}, "WEIGHTS_0": {}, "JOINTS_1": {},
           "WEIGHTS_1": {}}}}}]}}], {})",
        positions, first, weights, second, more, animation({{sampler(times, places), node(5, "translation")}})));
    for (const double t : {0.0, 1.0}) {
        const SceneDescription scene = t == 0 ? read(gltf).scene : at(t, gltf);
        const double z = t == 0 ? 10 : 30;
        EXPECT_NEAR(scene.meshes.at(0).positions[0].z, 0, 1e-6);
        EXPECT_NEAR(scene.meshes[0].positions[1].z, z / 5, 1e-5);
        EXPECT_NEAR(scene.meshes[0].positions[2].z, z / 2, 1e-5);
    }
}

/// A triangle that is degenerate at rest but not in another pose is kept.
TEST_F(GltfAnimation, TrianglesMayBeFlatAtRest)
{
    GltfBuilder b;
    const int positions = b.floats({0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0}, "VEC3");
    const int offsets = b.floats({0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0}, "VEC3");
    const int indices = b.accessor(b.view<std::uint16_t>({0, 1, 2, 0, 1, 3}), 5123, 6, "SCALAR");
    const int times = b.floats({0, 1}, "SCALAR"), weights = b.floats({0, 1}, "SCALAR");
    const std::string gltf = b.one_primitive(
        fmt::format(R"("attributes": {{"POSITION": {}}}, "indices": {}, "targets": [{{"POSITION": {}}}])", positions,
                    indices, offsets),
        animation({{sampler(times, weights), node(0, "weights")}}));
    EXPECT_EQ(read(gltf).scene.meshes[0].indices.size(), 3u);
    EXPECT_EQ(at(1, gltf).meshes[0].indices.size(), 6u);
    EXPECT_EQ(at(1, gltf).meshes[0].positions[2].y, 5);
}

TEST_F(GltfAnimation, PointersMoveNumbers)
{
    GltfBuilder b;
    const int mesh = b.triangle(), times = b.floats({0, 1}, "SCALAR");
    const int color = b.floats({0, 0, 0, 1, 1, 0.5, 0, 0.5}, "VEC4"), number = b.floats({0, 4}, "SCALAR");
    const int emissive = b.floats({0, 0, 0, 1, 0, 0.5}, "VEC3"), angle = b.floats({0.5, 1}, "SCALAR");
    const int tiny = b.floats({0, 0.5}, "SCALAR");
    const std::string lights = "/extensions/KHR_lights_punctual/lights/0/";
    const std::string gltf = b.gltf(fmt::format(
        R"("scenes": [{{"nodes": [0, 1, 2]}}],
           "nodes": [{{"mesh": 0}}, {{"camera": 0}}, {{"extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}],
           "cameras": [{{"type": "perspective", "perspective": {{"yfov": 1, "znear": 1}}}}],
           "extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "spot", "color": [1, 0.5, 0], "intensity": 3,
                                                                "spot": {{}}}}]}}}},
           "materials": [{{"alphaMode": "BLEND", "emissiveFactor": [0, 1, 0], "extensions":
                           {{"KHR_materials_emissive_strength": {{"emissiveStrength": 10}}}}}}],
           "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}, "material": 0}}]}}], {})",
        mesh,
        animation(
            {{sampler(times, color), pointer("/materials/0/pbrMetallicRoughness/baseColorFactor")},
             {sampler(times, tiny), pointer("/materials/0/pbrMetallicRoughness/roughnessFactor")},
             {sampler(times, emissive), pointer("/materials/0/emissiveFactor")},
             {sampler(times, number), pointer(lights + "intensity")},
             {sampler(times, tiny), pointer(lights + "spot/innerConeAngle")},
             {sampler(times, angle), pointer("/cameras/0/perspective/yfov")},
             {sampler(times, number), pointer("/materials/0/normalTexture/extensions/KHR_texture_transform/rotation")},
             {sampler(times, number), pointer("/materials/0/occlusionTexture/strength")}})));
    const SceneDescription scene = at(0.5, gltf);
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(m.base_color.value, (Color{0.5f, 0.25f, 0}));
    EXPECT_EQ(m.opacity.alpha.value, 0.75f);
    EXPECT_EQ(m.roughness.value, 0.25f);
    EXPECT_EQ(m.emission.radiance.value, (Color{5, 0, 2.5f}));
    EXPECT_EQ(scene.lights.at(0).intensity, (Color{2, 1, 0}));
    EXPECT_EQ(scene.lights[0].inner_angle, 0.25);
    EXPECT_EQ(scene.cameras.at(0).fov_y, 0.75);
    EXPECT_EQ(
        warning(),
        "animations of /materials/*/normalTexture/extensions/KHR_texture_transform/rotation are not supported and are "
        "ignored\nanimations of /materials/*/occlusionTexture/strength are not supported and are ignored\n");
    // Only the emissive strength is animated; its factor comes from the file.
    EXPECT_EQ(read(gltf).scene.materials[0].emission.radiance.value, (Color{0, 10, 0}));
}

TEST_F(GltfAnimation, NodesVanishAndComeBack)
{
    GltfBuilder b;
    const int mesh = b.triangle(), times = b.floats({0, 1, 2}, "SCALAR");
    const int seen = b.accessor(b.view<std::uint8_t>({0, 1, 0}), 5121, 3, "SCALAR");
    const int joints = b.accessor(b.view<std::uint8_t>(std::vector<std::uint8_t>(12, 0)), 5121, 3, "VEC4");
    const int weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    const std::string gltf = b.gltf(fmt::format(
        R"("scenes": [{{"nodes": [0]}}], "skins": [{{"joints": [2]}}],
           "nodes": [{{"mesh": 0, "children": [1, 2], "extensions": {{"KHR_node_visibility": {{"visible": false}}}}}},
                     {{"mesh": 1, "skin": 0}}, {{"mesh": 0}}],
           "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}}}]}},
                      {{"primitives": [{{"attributes": {{"POSITION": {}, "JOINTS_0": {}, "WEIGHTS_0": {}}}}}]}}], {})",
        mesh, mesh, joints, weights,
        animation({{sampler(times, seen, "STEP"), pointer("/nodes/0/extensions/KHR_node_visibility/visible")}})));
    EXPECT_TRUE(world_bounds(read(gltf).scene).empty);
    EXPECT_TRUE(world_bounds(at(0.5, gltf)).empty);
    const auto shapes = [](const SceneDescription& scene) {
        std::size_t count = 0;
        for (const Node& n : scene.nodes) count += n.shapes.size();
        return count;
    };
    EXPECT_EQ(shapes(at(0.5, gltf)), 1u);  // the child, which is not a scene root
    EXPECT_FALSE(world_bounds(at(1.5, gltf)).empty);
    EXPECT_EQ(shapes(at(1.5, gltf)), 3u);
    EXPECT_TRUE(world_bounds(at(2, gltf)).empty);
}

/// Damaged animation data is a warning when rendering a still image, and an error if the animation is requested.
TEST_F(GltfAnimation, DamagedDataIsNamed)
{
    GltfBuilder b;
    const int mesh = b.triangle(), times = b.floats({0, 1}, "SCALAR"), values = b.floats({0, 0, 0, 1, 1, 1}, "VEC3");
    const int same = b.floats({1, 1}, "SCALAR"), nan = b.floats({0, 0, 0, 1, NAN, 1}, "VEC3");
    const int back = b.floats({0, -INFINITY}, "SCALAR"), quaternions = b.floats({0, 0, 0, 1, 0, 0, 0, 1}, "VEC4");
    const auto problem = [&](const std::string& animations) {
        warnings_ = {};
        SceneFileContents file = read(b.gltf(fmt::format(
            R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}}}]}}], {})",
            mesh, animations)));
        EXPECT_EQ(file.scene.meshes.size(), 1u);
        const std::string told = warning();
        const std::string expected = "animations[0] can't be played: ";
        if (!told.starts_with(expected)) return told;
        EXPECT_THROW(AnimationPlayer(file.scene, file.rig, 0), Error);
        return told.substr(expected.size(), told.size() - expected.size() - 1);
    };
    const auto of = [&](int input, int output, const std::string& target, const char* interpolation = "LINEAR") {
        return problem(animation({{sampler(input, output, interpolation), target}}));
    };
    EXPECT_EQ(of(times, values, node(0, "translation")), "");
    EXPECT_EQ(of(same, values, node(0, "translation")),
              fmt::format("accessors[{}]: times must be finite and increase: 1 is the time of key 1", same));
    EXPECT_EQ(of(back, values, node(0, "translation")),
              fmt::format("accessors[{}]: times must be finite and increase: -inf is the time of key 1", back));
    EXPECT_EQ(of(values, values, node(0, "translation")),
              fmt::format("accessors[{}]: times with 3 components", values));
    EXPECT_EQ(of(times, nan, node(0, "translation")), fmt::format("accessors[{}]: a value is not finite", nan));
    EXPECT_EQ(of(times, values, node(0, "rotation")),
              fmt::format("accessors[{}]: 6 numbers are not 4 for each of 2 keys", values));
    EXPECT_EQ(of(times, quaternions, node(0, "rotation"), "CUBICSPLINE"),
              fmt::format("accessors[{}]: 8 numbers are not 12 for each of 2 keys", quaternions));
    EXPECT_EQ(of(times, values, node(7, "translation")),
              "animations[0].channels[0].target.node: there is no nodes[7]: the file has 1");
    EXPECT_EQ(of(99, values, node(0, "translation")),
              "animations[0].samplers[0].input: there is no accessors[99]: the file has 7");
    EXPECT_EQ(
        of(times, values, node(0, "colour")),
        "animations[0].channels[0].target.path: 'colour' is not one of translation, rotation, scale, weights, pointer");
    EXPECT_EQ(of(times, values, node(0, "translation"), "SPLINE"),
              "animations[0].samplers[0].interpolation: 'SPLINE' is not one of LINEAR, STEP, CUBICSPLINE");
    EXPECT_EQ(of(times, values, pointer("/nodes/3/translation")),
              "animations[0].channels[0].target.extensions.KHR_animation_pointer.pointer: there is no "
              "/nodes/3/translation: the file has 1 of them");
    EXPECT_EQ(
        problem(
            R"("animations": [{"samplers": [], "channels": [{"sampler": 0, "target": {"node": 0, "path": "scale"}}]}])"),
        "animations[0].channels[0].sampler: there is no sampler 0: the animation has 0");
    EXPECT_EQ(problem(R"("animations": [{"channels": []}])"), "animations[0]: key 'samplers' is missing");
    EXPECT_EQ(problem(R"("animations": [3])"), "animations[0]: key 'channels' is missing");
}

TEST_F(GltfAnimation, IsFoundByNameOrNumber)
{
    SceneFileContents file;
    file.scene.file = "a.gltf";
    EXPECT_THROW(find_animation(file, ""), Error);
    for (const char* name : {"walk", "run", "0"}) file.rig.animations.emplace_back().name = name;
    EXPECT_EQ(find_animation(file, ""), 0u);
    EXPECT_EQ(find_animation(file, "run"), 1u);
    EXPECT_EQ(find_animation(file, "1"), 1u);
    EXPECT_EQ(find_animation(file, "0"), 2u);
    try {
        find_animation(file, "wolk");
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.message(), "there is no animation 'wolk' among 'walk', 'run', '0'; did you mean 'walk'?");
    }
}

/// A model inside a scene is shown in its rest pose, with a warning.
TEST_F(GltfAnimation, ReportsAnimationsOfModelsWithinScenes)
{
    GltfBuilder b;
    const int mesh = b.triangle(), times = b.floats({0, 1}, "SCALAR"), values = b.floats({0, 0, 0, 1, 1, 1}, "VEC3");
    write("m.gltf", b.one_primitive(fmt::format(R"("attributes": {{"POSITION": {}}})", mesh),
                                    animation({{sampler(times, values), node(0, "translation")}})));
    const SceneFileContents file =
        load_scene_file(write("s.json", R"({"fathom": 1, "scene": [{"model": "m.gltf"}]})"), {}, warnings_);
    EXPECT_TRUE(file.rig.animations.empty());
    EXPECT_NE(warning().find("animations of a model within a scene are not supported"), std::string::npos);
}

}  // namespace
}  // namespace fathom::test
