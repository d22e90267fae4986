// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "formats/import_test_helpers.h"
#include "formats/mesh/mesh_fault_counts.h"
#include "gltf_builder.h"

namespace fathom::test {
namespace {

class Gltf : public ImportTest {
protected:
    /// Mesh of a file that has only one.
    Mesh mesh_of(const std::string& gltf)
    {
        const SceneDescription scene = load("a.gltf", gltf);
        EXPECT_EQ(scene.meshes.size(), 1u);
        return scene.meshes.empty() ? Mesh{} : scene.meshes[0];
    }
    std::size_t warning_count(const std::string& words) const
    {
        std::size_t count = 0;
        for (const auto& [message, times] : warnings_.counts())
            if (message.find(words) != std::string::npos) count += times;
        return count;
    }
};

void expect_equal(Vec3f a, Vec3f b)
{
    EXPECT_FLOAT_EQ(a.x, b.x);
    EXPECT_FLOAT_EQ(a.y, b.y);
    EXPECT_FLOAT_EQ(a.z, b.z);
}

TEST_F(Gltf, OneTriangle)
{
    GltfBuilder b;
    const int positions = b.triangle();
    const Mesh mesh = mesh_of(b.one_primitive(fmt::format(R"("attributes": {{"POSITION": {}}})", positions)));
    ASSERT_EQ(mesh.positions.size(), 3u);
    expect_equal(mesh.positions[1], {1, 0, 0});
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(Gltf, AttributesOfEveryType)
{
    GltfBuilder b;
    const int positions = b.accessor(b.view<std::int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0}, 8), 5122, 3,
                                     "VEC3", R"("normalized": true)");
    const int normals = b.accessor(b.view<std::int8_t>({0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, 4), 5120, 3, "VEC3",
                                   R"("normalized": true)");
    const int uv =
        b.accessor(b.view<std::uint16_t>({0, 65535, 32768, 0, 65535, 65535}), 5123, 3, "VEC2", R"("normalized": true)");
    const int uv1 = b.accessor(b.view<std::uint8_t>({0, 255, 0, 0, 51, 0, 0, 0, 1, 1, 0, 0}, 4), 5121, 3, "VEC2");
    const int colors = b.accessor(b.view<std::uint8_t>({255, 0, 51, 0, 0, 255, 0, 0, 0, 0, 255, 0}, 4), 5121, 3, "VEC3",
                                  R"("normalized": true)");
    const int tangents = b.floats({1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1}, "VEC4");
    const int indices = b.accessor(b.view<std::uint8_t>({2, 1, 0}), 5121, 3, "SCALAR");
    const Mesh mesh = mesh_of(b.one_primitive(
        fmt::format(R"("indices": {}, "attributes": {{"POSITION": {}, "NORMAL": {}, "TEXCOORD_0": {}, "TEXCOORD_1": {},
                       "COLOR_0": {}, "TANGENT": {}}})",
                    indices, positions, normals, uv, uv1, colors, tangents)));
    expect_equal(mesh.positions.at(1), {1, 0, 0});
    expect_equal(mesh.positions.at(2), {0, -1, 0});  // -32768 also decodes to -1
    expect_equal(mesh.normals.at(2), {0, 0, 1});
    EXPECT_FLOAT_EQ(mesh.uvs[0].at(1).x, 32768 / 65535.0f);
    EXPECT_FLOAT_EQ(mesh.uvs[0].at(0).y, 1);
    EXPECT_FLOAT_EQ(mesh.uvs[1].at(1).x, 51);  // an accessor that is not normalized
    EXPECT_FLOAT_EQ(mesh.colors.at(0).z, 0.2f);
    EXPECT_FLOAT_EQ(mesh.colors.at(0).w, 1);  // colors of three components are opaque
    EXPECT_FLOAT_EQ(mesh.tangents.at(1).w, -1);
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{2, 1, 0}));
}

TEST_F(Gltf, InterleavedWithOffset)
{
    GltfBuilder b;
    const int view = b.view<float>({9, 9, 0, 0, 0, 0, 0, 1, 9, 9, 1, 0, 0, 0, 0, 1, 9, 9, 0, 1, 0, 0, 0, 1}, 32);
    const int positions = b.accessor(view, 5126, 3, "VEC3", R"("byteOffset": 8)");
    const int normals = b.accessor(view, 5126, 3, "VEC3", R"("byteOffset": 20)");
    const Mesh mesh =
        mesh_of(b.one_primitive(fmt::format(R"("attributes": {{"POSITION": {}, "NORMAL": {}}})", positions, normals)));
    expect_equal(mesh.positions.at(2), {0, 1, 0});
    expect_equal(mesh.normals.at(0), {0, 0, 1});
}

TEST_F(Gltf, SparseWithAndWithoutBase)
{
    GltfBuilder b;
    const int base = b.view<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int which = b.view<std::uint16_t>({1, 2});
    const int values = b.view<float>({5, 0, 0, 0, 6, 0});
    const std::string sparse = fmt::format(
        R"("sparse": {{"count": 2, "indices": {{"bufferView": {}, "componentType": 5123}}, "values": {{"bufferView": {}}}}})",
        which, values);
    for (int view : {base, -1}) {
        GltfBuilder copy = b;
        const int positions = copy.accessor(view, 5126, 3, "VEC3", sparse);
        const Mesh mesh = mesh_of(copy.one_primitive(fmt::format(R"("attributes": {{"POSITION": {}}})", positions)));
        expect_equal(mesh.positions.at(0), {0, 0, 0});
        expect_equal(mesh.positions.at(1), {5, 0, 0});
        expect_equal(mesh.positions.at(2), {0, 6, 0});
    }
}

TEST_F(Gltf, PrimitiveModes)
{
    GltfBuilder b;
    const int positions = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3");
    const auto indices_of = [&](int mode) {
        const SceneDescription scene = load(
            "a.gltf", b.one_primitive(fmt::format(R"("mode": {}, "attributes": {{"POSITION": {}}})", mode, positions)));
        return scene.meshes.empty() ? std::vector<std::uint32_t>{} : scene.meshes[0].indices;
    };
    EXPECT_EQ(indices_of(4), (std::vector<std::uint32_t>{0, 1, 2}));  // two extra indices are ignored
    EXPECT_EQ(warning_count("don't complete a triangle"), 2u);
    EXPECT_EQ(indices_of(5), (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4}));
    EXPECT_EQ(indices_of(6), (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 3, 4}));
    for (int mode : {0, 1, 2, 3}) EXPECT_TRUE(indices_of(mode).empty());
}

TEST_F(Gltf, PointsAndLines)
{
    GltfBuilder b;
    // Box of 3 by 4 by 12 with diagonal 13; the last vertex is unused.
    const int positions = b.floats({0, 0, 0, 3, 0, 0, 0, 4, 0, 3, 4, 12, 0, 0, 12, 99, 99, 99}, "VEC3");
    const int indices = b.accessor(b.view<std::uint16_t>({4, 0, 3, 1, 2}), 5123, 5, "SCALAR");
    const auto load_mode = [&](int mode) {
        return load("a.gltf",
                    b.one_primitive(fmt::format(R"("mode": {}, "indices": {}, "attributes": {{"POSITION": {}}})", mode,
                                                indices, positions)));
    };
    const SceneDescription cloud = load_mode(0);
    ASSERT_EQ(cloud.points.size(), 1u);
    ASSERT_EQ(cloud.points[0].centers.size(), 5u);
    expect_equal(cloud.points[0].centers[0], {0, 0, 12});
    EXPECT_FLOAT_EQ(cloud.points[0].radii[4], float(0.5 * 13 / std::sqrt(5.0)));
    EXPECT_TRUE(std::holds_alternative<PointsInstance>(cloud.nodes[0].shapes.at(0).geometry));

    const auto expect_lines = [&](int mode, const std::vector<std::uint32_t>& counts, Vec3f last) {
        const SceneDescription scene = load_mode(mode);
        ASSERT_EQ(scene.curves.size(), 1u);
        const Curves& c = scene.curves[0];
        EXPECT_EQ(c.basis, CurveBasis::linear);
        EXPECT_FALSE(c.ribbons);
        EXPECT_EQ(c.counts, counts);
        expect_equal(c.points.front(), {0, 0, 12});
        expect_equal(c.points.back(), last);
        EXPECT_EQ(c.radii, std::vector<float>(c.points.size(), 0.013f));
        EXPECT_TRUE(std::holds_alternative<CurvesInstance>(scene.nodes[0].shapes.at(0).geometry));
    };
    EXPECT_TRUE(warnings_.empty());
    expect_lines(1, {2, 2}, {3, 0, 0});
    EXPECT_EQ(warning_count("don't complete a line"), 1u);
    expect_lines(2, {6}, {0, 0, 12});
    expect_lines(3, {5}, {0, 4, 0});
}

TEST_F(Gltf, PointsAndLinesThatAreNotFinite)
{
    GltfBuilder b;
    const float nan = std::nanf("");
    const int positions = b.floats({0, 0, 0, nan, 0, 0, 0, 4, 0, 3, 4, 12}, "VEC3");
    const auto load_mode = [&](int mode) {
        return load("a.gltf",
                    b.one_primitive(fmt::format(R"("mode": {}, "attributes": {{"POSITION": {}}})", mode, positions)));
    };
    EXPECT_EQ(load_mode(0).points.at(0).centers.size(), 3u);
    EXPECT_EQ(load_mode(1).curves.at(0).counts, (std::vector<std::uint32_t>{2}));
    EXPECT_EQ(load_mode(3).curves.at(0).counts, (std::vector<std::uint32_t>{3}));
    EXPECT_EQ(warning_count("points that are not finite"), 3u);
}

TEST_F(Gltf, OnlyTheVerticesOfThePrimitiveAreKept)
{
    GltfBuilder b;
    std::vector<float> many(3000);
    for (std::size_t i = 0; i < many.size(); ++i) many[i] = float(i * i % 97);
    const int positions = b.floats(many, "VEC3");
    const int indices = b.accessor(b.view<std::uint32_t>({500, 502, 501}), 5125, 3, "SCALAR");
    const Mesh mesh =
        mesh_of(b.one_primitive(fmt::format(R"("indices": {}, "attributes": {{"POSITION": {}}})", indices, positions)));
    ASSERT_EQ(mesh.positions.size(), 3u);
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 2, 1}));
    expect_equal(mesh.positions[0], {many[1500], many[1501], many[1502]});
}

TEST_F(Gltf, MaterialsAndTextures)
{
    GltfBuilder b;
    const int positions = b.triangle();
    const SceneDescription scene =
        load("a.gltf",
             b.gltf(fmt::format(R"(
        "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}],
        "meshes": [{{"primitives": [{0}, {1}, {2}, {3}, {4}, {5}]}}],
        "extensionsUsed": ["KHR_materials_unlit", "KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_texture_transform",
                           "KHR_materials_volume", "KHR_materials_transmission", "VENDOR_fur"],
        "images": [{{"uri": "my%20wood.png"}}, {{"uri": "data:image/png;base64,AQID"}}],
        "samplers": [{{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}}],
        "textures": [{{"source": 0, "sampler": 0}}, {{"source": 1}}],
        "materials": [
          {{"name": "full", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25, "emissiveFactor": [1, 0.5, 0],
            "emissiveTexture": {{"index": 0}}, "normalTexture": {{"index": 0, "scale": 2}},
            "pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.25, 1, 0.75], "metallicFactor": 0.125, "roughnessFactor": 0.375,
              "baseColorTexture": {{"index": 0, "texCoord": 1, "extensions": {{"KHR_texture_transform":
                {{"offset": [1, 2], "scale": [3, 4], "rotation": 0.5}}}}}},
              "metallicRoughnessTexture": {{"index": 1}}}},
            "extensions": {{"KHR_materials_emissive_strength": {{"emissiveStrength": 10}}, "KHR_materials_ior": {{"ior": 1.8}}}}}},
          {{"name": "unlit", "extensions": {{"KHR_materials_unlit": {{}}}}}},
          {{"name": "glass", "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 1}},
            "KHR_materials_volume": {{"thicknessFactor": 1, "attenuationColor": [0.5, 1, 1], "attenuationDistance": 2}}}}}},
          {{"name": "pane", "pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.25, 1, 1], "baseColorTexture": {{"index": 0}}}},
            "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 1}},
            "KHR_materials_volume": {{"thicknessFactor": 0}}}}}},
          {{"name": "opaque", "pbrMetallicRoughness": {{"baseColorFactor": [1, 1, 1, 0.5]}}}}])",
                                fmt::format(R"({{"material": 0, "attributes": {{"POSITION": {}}}}})", positions),
                                fmt::format(R"({{"material": 1, "attributes": {{"POSITION": {}}}}})", positions),
                                fmt::format(R"({{"material": 2, "attributes": {{"POSITION": {}}}}})", positions),
                                fmt::format(R"({{"material": 3, "attributes": {{"POSITION": {}}}}})", positions),
                                fmt::format(R"({{"attributes": {{"POSITION": {}}}}})", positions),
                                fmt::format(R"({{"material": 4, "attributes": {{"POSITION": {}}}}})", positions))));
    ASSERT_EQ(scene.materials.size(), 6u);
    const Material& full = scene.materials[0];
    EXPECT_EQ(full.kind, MaterialKind::principled);
    EXPECT_EQ(full.base_color.value, (Color{0.5f, 0.25f, 1}));
    EXPECT_EQ(full.opacity.alpha.value, 0.75f);
    EXPECT_EQ(full.opacity.alpha.texture, full.base_color.texture);
    EXPECT_EQ(full.opacity.alpha.channel, 3);
    EXPECT_EQ(full.opacity.mode, AlphaMode::mask);
    EXPECT_EQ(full.opacity.cutoff, 0.25f);
    EXPECT_EQ(full.metallic.value, 0.125f);
    EXPECT_EQ(full.metallic.channel, 2);
    EXPECT_EQ(full.roughness.value, 0.375f);
    EXPECT_EQ(full.roughness.channel, 1);
    EXPECT_EQ(full.roughness.texture, full.metallic.texture);
    EXPECT_EQ(full.emission.radiance.value, (Color{10, 5, 0}));
    EXPECT_TRUE(full.emission.two_sided);
    EXPECT_FALSE(full.visibility.camera_backface_culling);
    EXPECT_TRUE(scene.materials[1].visibility.camera_backface_culling);
    EXPECT_EQ(full.normal_map.scale, 2);
    EXPECT_EQ(full.ior, 1.8f);
    const Texture& color = scene.textures[full.base_color.texture];
    EXPECT_EQ(color.color_space, ColorSpace::srgb);
    EXPECT_EQ(color.uv_set, 1);
    EXPECT_EQ(color.uv_offset.y, 2);
    EXPECT_EQ(color.uv_scale.x, 3);
    EXPECT_EQ(color.uv_rotation, 0.5f);
    EXPECT_EQ(color.wrap_u, Wrap::clamp);
    EXPECT_EQ(color.wrap_v, Wrap::mirror);
    EXPECT_TRUE(color.nearest);
    EXPECT_EQ(scene.textures[full.normal_map.texture].color_space, ColorSpace::linear);
    ASSERT_GE(full.emission.radiance.texture, 0);
    EXPECT_EQ(scene.textures[full.emission.radiance.texture].color_space, ColorSpace::srgb);
    EXPECT_EQ(scene.textures[full.metallic.texture].color_space, ColorSpace::linear);
    EXPECT_EQ(scene.textures[full.metallic.texture].wrap_u, Wrap::repeat);
    EXPECT_EQ(scene.images[color.image].path, folder_ / "my wood.png");
    const ImageFile& embedded = scene.images[scene.textures[full.metallic.texture].image];
    EXPECT_EQ(embedded.bytes, (std::vector<std::byte>{std::byte{1}, std::byte{2}, std::byte{3}}));
    EXPECT_EQ(scene.images.size(), 2u);

    EXPECT_EQ(scene.materials[1].kind, MaterialKind::unlit);
    EXPECT_EQ(scene.materials[2].transmission.weight.value, 1);
    EXPECT_EQ(scene.materials[2].interior.attenuation_color, (Color{0.5f, 1, 1}));
    EXPECT_EQ(scene.materials[2].interior.attenuation_distance, 2);
    EXPECT_FALSE(scene.materials[2].interior.thin);
    EXPECT_EQ(scene.materials[2].transmission.color.value, (Color{1, 1, 1}));
    EXPECT_EQ(scene.materials[3].transmission.weight.value, 1);
    EXPECT_TRUE(scene.materials[3].interior.thin);
    EXPECT_EQ(scene.materials[3].transmission.color.value, (Color{0.5f, 0.25f, 1}));
    EXPECT_GE(scene.materials[3].transmission.color.texture, 0);
    EXPECT_EQ(scene.materials[5].opacity.alpha.value, 1);  // opaque mode ignores alpha
    EXPECT_EQ(scene.materials[4].base_color.value, (Color{1, 1, 1}));
    EXPECT_EQ(scene.materials[4].metallic.value, 1);
    EXPECT_EQ(warning_count("VENDOR_fur"), 1u);
    EXPECT_EQ(warnings_.counts().size(), 1u);
}

TEST_F(Gltf, CamerasLightsAndTransforms)
{
    const SceneDescription scene =
        load("a.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [
            {"type": "spot", "color": [1, 0.5, 0], "intensity": 10, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
            {"type": "directional", "intensity": 3}]}},
        "cameras": [{"type": "perspective", "name": "main", "perspective": {"yfov": 0.5, "znear": 0.1, "aspectRatio": 2}},
                    {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 3, "znear": 0, "zfar": 9}}],
        "nodes": [{"children": [1, 2], "translation": [1, 2, 3], "rotation": [0, 0, 0.7071067811865476, 0.7071067811865476],
                   "scale": [2, 3, 4]},
                  {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
                  {"camera": 1, "extensions": {"KHR_lights_punctual": {"light": 1}},
                   "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1]}]})");
    EXPECT_TRUE(warnings_.empty());
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_EQ(scene.cameras[0].name, "main");
    EXPECT_EQ(scene.cameras[0].fov_y, 0.5);
    EXPECT_EQ(scene.cameras[1].kind, CameraKind::orthographic);
    EXPECT_EQ(scene.cameras[1].height, 6);
    ASSERT_EQ(scene.lights.size(), 2u);
    EXPECT_EQ(scene.lights[0].kind, LightKind::spot);
    EXPECT_EQ(scene.lights[0].intensity, (Color{10, 5, 0}));
    EXPECT_EQ(scene.lights[0].outer_angle, 0.5);
    EXPECT_EQ(scene.lights[1].kind, LightKind::directional);
    const Transform& t = scene.nodes[0].parent_from_node;
    expect_near(t.point({1, 1, 1}), {1 - 3, 2 + 2, 3 + 4}, 1e-12);
    expect_near(scene.nodes[2].parent_from_node.point({1, 1, 1}), {8, 9, 10});
}

/// Range is ignored because physical light has none; one warning reports it.
TEST_F(Gltf, RangeOfLightsIsReported)
{
    const auto file = [](const char* first, const char* second) {
        return fmt::format(R"({{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0, 1]}}],
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {{"KHR_lights_punctual": {{"lights": [{}, {}]}}}},
            "nodes": [{{"extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}},
                      {{"extensions": {{"KHR_lights_punctual": {{"light": 1}}}}}}]}})",
                           first, second);
    };
    load("a.gltf", file(R"({"type": "point"})", R"({"type": "directional", "range": 3})"));
    EXPECT_EQ(warning_count("range"), 0u);
    load("b.gltf", file(R"({"type": "point", "range": 2})", R"({"type": "spot", "range": 3, "spot": {}})"));
    EXPECT_EQ(warning_count("range"), 2u);
    EXPECT_EQ(warnings_.counts().size(), 1u);
}

/// All numbers differ, so transposed, swapped or neighboring values are detected.
TEST_F(Gltf, OddTransforms)
{
    const SceneDescription scene = load("a.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"matrix": [2, 3, 5, 0, 7, 11, 13, 0, 17, 19, 23, 0, 29, 31, 37, 1]},
                  {"rotation": [0.1, 0.5, -0.7, 0.5], "scale": [2, 3, 4], "translation": [1, 2, 3]}]})");
    // Matrices are stored by columns.
    expect_near(scene.nodes[0].parent_from_node.point({1, 10, 100}),
                {2 + 70 + 1700 + 29, 3 + 110 + 1900 + 31, 5 + 130 + 2300 + 37});
    // Scale, then rotation by the quaternion x, y, z, w (sandwich product), then translation.
    const Vec3d v{2 * 1.0, 3 * -1.0, 4 * 0.5}, u{0.1, 0.5, -0.7}, t = cross(u, v) * 2.0;
    expect_near(scene.nodes[1].parent_from_node.point({1, -1, 0.5}), v + t * 0.5 + cross(u, t) + Vec3d{1, 2, 3}, 1e-12);
}

TEST_F(Gltf, IndicesOfEveryTypeAndSparseOnes)
{
    GltfBuilder b;
    const int positions = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
    const int wide = b.accessor(b.view<std::uint32_t>({0, 2, 3}), 5125, 3, "SCALAR");
    const int middle = b.accessor(b.view<std::uint16_t>({0, 2, 3}), 5123, 3, "SCALAR");
    const int narrow = b.accessor(b.view<std::uint8_t>({0, 2, 3}), 5121, 3, "SCALAR");
    const int which = b.view<std::uint32_t>({0, 2}), values = b.view<std::uint16_t>({3, 1});
    const int sparse = b.accessor(
        b.view<std::uint16_t>({0, 2, 3}), 5123, 3, "SCALAR",
        fmt::format(
            R"("sparse": {{"count": 2, "indices": {{"bufferView": {}, "componentType": 5125}}, "values": {{"bufferView": {}}}}})",
            which, values));
    const auto positions_of = [&](int indices) {
        const Mesh mesh = mesh_of(
            b.one_primitive(fmt::format(R"("indices": {}, "attributes": {{"POSITION": {}}})", indices, positions)));
        std::vector<int> corners;
        // At most one coordinate of each vertex is 1, which identifies the vertex.
        for (std::uint32_t i : mesh.indices) {
            const Vec3f p = mesh.positions.at(i);
            corners.push_back(p.x == 1 ? 1 : p.y == 1 ? 2 : p.z == 1 ? 3 : 0);
        }
        return corners;
    };
    for (int accessor : {wide, middle, narrow}) EXPECT_EQ(positions_of(accessor), (std::vector<int>{0, 2, 3}));
    EXPECT_EQ(positions_of(sparse), (std::vector<int>{3, 2, 1}));
}

/// Byte strides may be larger than the elements, also for integers and matrices.
TEST_F(Gltf, Strides)
{
    GltfBuilder b;
    const int positions = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
    const int uv = b.accessor(b.view<float>({0.5f, 0.25f, 9, 9, 0.75f, 1, 9, 9, 0.125f, 2, 9, 9}, 16), 5126, 3, "VEC2");
    const int colors =
        b.accessor(b.view<std::uint16_t>({65535, 0, 13107, 1, 2, 3, 0, 65535, 0, 1, 2, 3, 0, 0, 65535, 1, 2, 3}, 12),
                   5123, 3, "VEC3", R"("normalized": true)");
    const Mesh mesh = mesh_of(b.one_primitive(
        fmt::format(R"("attributes": {{"POSITION": {}, "TEXCOORD_0": {}, "COLOR_0": {}}})", positions, uv, colors)));
    EXPECT_EQ(mesh.uvs[0].at(1).x, 0.75f);
    EXPECT_EQ(mesh.uvs[0].at(2).y, 2);
    EXPECT_FLOAT_EQ(mesh.colors.at(0).z, 0.2f);
    EXPECT_FLOAT_EQ(mesh.colors.at(1).y, 1);
    EXPECT_FLOAT_EQ(mesh.colors.at(2).z, 1);
}

/// Skins transform normals by the inverse transpose, so they stay perpendicular under nonuniform scale.
TEST_F(Gltf, SkinsBendNormals)
{
    GltfBuilder b;
    // The mesh is a slope with normal (0, 1, 1) in the plane y = 1 - z.
    const int positions = b.floats({0, 1, 0, 1, 1, 0, 0, 0, 1}, "VEC3");
    const float h = float(std::sqrt(0.5));
    const int normals = b.floats({0, h, h, 0, h, h, 0, h, h}, "VEC3");
    const int joints = b.accessor(b.view<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}), 5121, 3, "VEC4");
    const int weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    const SceneDescription scene = load("a.gltf", b.gltf(fmt::format(R"(
        "scenes": [{{"nodes": [0, 1]}}], "skins": [{{"joints": [1]}}],
        "nodes": [{{"mesh": 0, "skin": 0}}, {{"scale": [1, 1, 3], "rotation": [0, 0, 0.6, 0.8]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}, "NORMAL": {}, "JOINTS_0": {}, "WEIGHTS_0": {}}}}}]}}])",
                                                                     positions, normals, joints, weights)));
    const Mesh& mesh = scene.meshes.at(0);
    const auto at = [&](std::size_t i) { return Vec3d{mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z}; };
    const Vec3d face = normalize(cross(at(1) - at(0), at(2) - at(0)));
    const Vec3d n{mesh.normals[1].x, mesh.normals[1].y, mesh.normals[1].z};
    EXPECT_NEAR(std::abs(dot(face, n)), 1, 1e-6);
    EXPECT_GT(dot(n, {0, 0, 1}), 0);
}

TEST_F(Gltf, MorphsAndInstancesTurn)
{
    GltfBuilder b;
    const int positions = b.triangle();
    const int normals = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int offsets = b.floats({0, 2, 0, 0, 2, 0, 0, 2, 0}, "VEC3");
    const Mesh morphed = mesh_of(b.gltf(fmt::format(
        R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}], "meshes": [{{"weights": [0, 0.5], "primitives":
        [{{"attributes": {{"POSITION": {0}, "NORMAL": {1}}}, "targets": [{{"POSITION": {1}}}, {{"NORMAL": {2}}}]}}]}}])",
        positions, normals, offsets)));
    expect_equal(morphed.normals[0], {0, 1, 1});
    expect_equal(morphed.positions[1], {1, 0, 0});

    const int translations = b.floats({1, 2, 3, 4, 5, 6}, "VEC3");
    const int rotations = b.floats({0, 0, 0, 1, 0.1f, 0.5f, -0.7f, 0.5f}, "VEC4");
    const int scales = b.floats({1, 1, 1, 2, 3, 4}, "VEC3");
    const SceneDescription scene = load("a.gltf", b.gltf(fmt::format(R"(
        "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0, "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes":
            {{"TRANSLATION": {}, "ROTATION": {}, "SCALE": {}}}}}}}}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}}}]}}])",
                                                                     translations, rotations, scales, positions)));
    const Vec3d v{2, -3, 2}, u{0.1f, 0.5f, -0.7f}, t = cross(u, v) * (2 / (dot(u, u) + 0.25));
    expect_near(scene.nodes.at(2).parent_from_node.point({1, -1, 0.5}), v + t * 0.5 + cross(u, t) + Vec3d{4, 5, 6},
                1e-6);
}

TEST_F(Gltf, ScenesAreChosenByNameOrNumber)
{
    const std::string gltf =
        R"({"asset": {"version": "2.0"}, "scene": 1, "scenes": [{"name": "a", "nodes": [0]}, {"nodes": [1]}],
                                 "nodes": [{"name": "first"}, {"name": "second"}]})";
    const auto path = write("a.gltf", gltf);
    const auto root_of = [&](const std::string& wanted) {
        LoadOptions options;
        options.scene = wanted;
        const SceneDescription scene = load_scene(path, options, warnings_);
        return scene.nodes[scene.roots.at(0)].name;
    };
    EXPECT_EQ(root_of(""), "second");
    EXPECT_EQ(root_of("a"), "first");
    EXPECT_EQ(root_of("0"), "first");
    EXPECT_EQ(root_of("1"), "second");
    EXPECT_THROW(root_of("b"), Error);
    // Without scenes, all nodes that have no parent are roots.
    const SceneDescription all =
        load("b.gltf", R"({"asset": {"version": "2.0"}, "nodes": [{"children": [2]}, {}, {}]})");
    EXPECT_EQ(all.roots, (std::vector<int>{0, 1}));
}

TEST_F(Gltf, SkinsStandInTheirPose)
{
    GltfBuilder b;
    const int positions = b.floats({0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3");
    const int normals = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const int joints = b.accessor(b.view<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}), 5121, 3, "VEC4");
    const int weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0}, "VEC4");  // the last vertex's weights sum to 2
    const int bind = b.floats(
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -5, 1}, "MAT4");
    const SceneDescription scene = load("a.gltf", b.gltf(fmt::format(R"(
        "scenes": [{{"nodes": [0, 1]}}], "skins": [{{"joints": [1, 2], "inverseBindMatrices": {}}}],
        "nodes": [{{"mesh": 0, "skin": 0, "translation": [100, 0, 0]}}, {{"children": [2], "translation": [0, 10, 0]}},
                  {{"translation": [0, 0, 20]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}, "NORMAL": {}, "JOINTS_0": {}, "WEIGHTS_0": {}}}}}]}}])",
                                                                     bind, positions, normals, joints, weights)));
    ASSERT_EQ(scene.meshes.size(), 1u);
    expect_equal(scene.meshes[0].positions[0], {0, 10, 0});
    expect_equal(scene.meshes[0].positions[1], {1, 10, 15});
    expect_equal(scene.meshes[0].positions[2], {0, 12, 7.5f});
    // A skinned mesh ignores its node's own transform.
    const Bounds bounds = world_bounds(scene);
    EXPECT_EQ(bounds.max, (Vec3d{1, 12, 15}));
}

TEST_F(Gltf, MorphTargetsAtRest)
{
    GltfBuilder b;
    const int positions = b.triangle();
    const int offsets = b.floats({0, 0, 1, 0, 0, 2, 0, 0, 3}, "VEC3");
    const auto gltf = [&](const std::string& mesh_weights, const std::string& node_weights) {
        return b.gltf(
            fmt::format(R"("scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0 {}}}], "meshes": [{{"primitives":
            [{{"attributes": {{"POSITION": {}}}, "targets": [{{"POSITION": {}}}]}}] {}}}])",
                        node_weights, positions, offsets, mesh_weights));
    };
    EXPECT_EQ(mesh_of(gltf("", "")).positions[2].z, 0);
    EXPECT_EQ(mesh_of(gltf(R"(, "weights": [0.5])", "")).positions[2].z, 1.5f);
    EXPECT_EQ(mesh_of(gltf(R"(, "weights": [0.5])", R"(, "weights": [2])")).positions[2].z, 6);
}

TEST_F(Gltf, GpuInstancing)
{
    GltfBuilder b;
    const int positions = b.triangle();
    const int translations = b.floats({0, 0, 0, 10, 0, 0}, "VEC3");
    const int scales = b.floats({1, 1, 1, 2, 2, 2}, "VEC3");
    const SceneDescription scene = load("a.gltf", b.gltf(fmt::format(R"(
        "extensionsRequired": ["EXT_mesh_gpu_instancing"], "extensionsUsed": ["EXT_mesh_gpu_instancing"],
        "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0, "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes":
            {{"TRANSLATION": {}, "SCALE": {}}}}}}}}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}}}]}}])",
                                                                     translations, scales, positions)));
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(world_bounds(scene).max, (Vec3d{12, 2, 0}));
}

TEST_F(Gltf, InvisibleNodes)
{
    GltfBuilder b;
    const int positions = b.triangle();
    const SceneDescription scene = load("a.gltf", b.gltf(fmt::format(R"(
        "scenes": [{{"nodes": [0, 2]}}], "extensionsUsed": ["KHR_node_visibility"],
        "nodes": [{{"children": [1], "extensions": {{"KHR_node_visibility": {{"visible": false}}}}}}, {{"mesh": 0}}, {{}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {}}}}}]}}])",
                                                                     positions)));
    EXPECT_TRUE(world_bounds(scene).empty);
}

TEST_F(Gltf, WhatIsWrongWithVerticesIsMended)
{
    GltfBuilder b;
    const int positions = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0}, "VEC3");
    const int normals = b.floats({0, 0, 0, 0, 0, 1, NAN, 0, 1, 0, 0, 0}, "VEC3");
    const int uvs = b.floats({0, 0, INFINITY, 0, 0, 1, 0, 0}, "VEC2");
    // The second triangle is degenerate: three collinear points.
    const int indices = b.accessor(b.view<std::uint16_t>({0, 1, 2, 0, 1, 3}), 5123, 6, "SCALAR");
    const Mesh mesh = mesh_of(b.one_primitive(
        fmt::format(R"("indices": {}, "attributes": {{"POSITION": {}, "NORMAL": {}, "TEXCOORD_0": {}}})", indices,
                    positions, normals, uvs)));
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    expect_equal(mesh.normals[0], {0, 0, 1});
    expect_equal(mesh.normals[2], {0, 0, 1});
    EXPECT_EQ(mesh.uvs[0][1].x, 0);
    EXPECT_EQ(count_in_all(warnings_, "degenerate triangles"), 1u);
    EXPECT_EQ(count_in_all(warnings_, "normals of zero length or not finite"), 2u);
    EXPECT_EQ(count_in_all(warnings_, "that are not finite"), 1u);
}

}  // namespace
}  // namespace fathom::test
