// SPDX-License-Identifier: Apache-2.0
#include "scene/append.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

/// A scene with one element of each kind, which refer to each other.
SceneDescription scene_of(const std::string& name)
{
    SceneDescription s;
    s.images.resize(1);
    s.measured.resize(1);
    s.measured[0].name = name;
    s.images[0].name = name;
    s.textures.resize(2);
    s.textures[1].name = name, s.textures[1].image = 0;
    s.textures[0].color_a.texture = s.textures[0].color_b.texture = s.textures[0].factor.texture = 1;
    s.materials.resize(1);
    Material& m = s.materials[0];
    m.name = name;
    m.base_color.texture = m.transmission.color.texture = m.roughness.texture = m.metallic.texture = 1;
    m.emission.radiance.texture = m.opacity.alpha.texture = m.normal_map.texture = 1;
    m.mixture.material_a = m.mixture.material_b = m.measured = 0;
    s.meshes.resize(1), s.meshes[0].name = name;
    s.curves.resize(1), s.curves[0].name = name;
    s.points.resize(1), s.points[0].name = name;
    s.lights.resize(1), s.lights[0].name = name, s.lights[0].picture.image = 0;
    s.cameras.resize(1), s.cameras[0].name = name;
    s.nodes.resize(2);
    s.nodes[0].name = name, s.nodes[0].children = {1};
    Node& n = s.nodes[1];
    n.name = name;
    n.light = n.camera = 0;
    n.shapes = {{MeshInstance{0}, 0, name}, {CurvesInstance{0}, -1, name}, {PointsInstance{0}, 0, name}};
    s.roots = {0};
    return s;
}

TEST(AppendScene, EverythingStillRefersToItsOwn)
{
    SceneDescription all;
    std::vector<Appended> parts;
    for (const char* name : {"a", "b", "c"}) parts.push_back(append_scene(all, scene_of(name)));
    const char* names[] = {"a", "b", "c"};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string name = names[i];
        ASSERT_EQ(parts[i].roots.size(), 1u);
        const Node& root = all.nodes[std::size_t(parts[i].roots[0])];
        EXPECT_EQ(root.name, name);
        const Node& n = all.nodes[std::size_t(root.children.at(0))];
        EXPECT_EQ(n.name, name);
        EXPECT_EQ(all.lights[std::size_t(n.light)].name, name);
        EXPECT_EQ(all.images[std::size_t(all.lights[std::size_t(n.light)].picture.image)].name, name);
        EXPECT_EQ(all.cameras[std::size_t(n.camera)].name, name);
        EXPECT_EQ(all.meshes[std::size_t(std::get<MeshInstance>(n.shapes[0].geometry).mesh)].name, name);
        EXPECT_EQ(all.curves[std::size_t(std::get<CurvesInstance>(n.shapes[1].geometry).curves)].name, name);
        EXPECT_EQ(all.points[std::size_t(std::get<PointsInstance>(n.shapes[2].geometry).points)].name, name);
        EXPECT_EQ(n.shapes[1].material, -1);
        const Material& m = all.materials[std::size_t(n.shapes[0].material)];
        EXPECT_EQ(m.name, name);
        EXPECT_EQ(all.measured[std::size_t(m.measured)].name, name);
        EXPECT_EQ(m.mixture.material_a, n.shapes[0].material);
        EXPECT_EQ(m.mixture.material_b, n.shapes[0].material);
        EXPECT_EQ(parts[i].first_material, n.shapes[0].material);
        EXPECT_EQ(parts[i].material_end, n.shapes[0].material + 1);
        for (int texture : {m.base_color.texture, m.transmission.color.texture, m.roughness.texture, m.metallic.texture,
                            m.emission.radiance.texture, m.opacity.alpha.texture, m.normal_map.texture}) {
            EXPECT_EQ(all.textures[std::size_t(texture)].name, name);
            EXPECT_EQ(all.images[std::size_t(all.textures[std::size_t(texture)].image)].name, name);
            // The preceding texture refers to it.
            const Texture& node = all.textures[std::size_t(texture) - 1];
            EXPECT_EQ(node.image, -1);
            for (int input : {node.color_a.texture, node.color_b.texture, node.factor.texture})
                EXPECT_EQ(input, texture);
        }
    }
}

TEST(CopyNodes, AreAnotherSetOfTheSame)
{
    SceneDescription all;
    append_scene(all, scene_of("a"));
    const Appended b = append_scene(all, scene_of("b"));
    const Appended copy = copy_nodes(all, b);
    EXPECT_EQ(copy.first_node, b.node_end);
    EXPECT_EQ(copy.node_end, b.node_end + 2);
    EXPECT_EQ(copy.roots, std::vector<int>{b.roots[0] + 2});
    EXPECT_EQ(all.nodes[std::size_t(copy.roots[0])].children, std::vector<int>{copy.roots[0] + 1});
    EXPECT_EQ(all.nodes[std::size_t(b.roots[0])].children, std::vector<int>{b.roots[0] + 1});
}

}  // namespace
}  // namespace fathom
