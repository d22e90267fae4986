// SPDX-License-Identifier: Apache-2.0
#include "fathom/scene_builder.h"

#include <gtest/gtest.h>

#include "fathom/error.h"

namespace fathom {

namespace {

TEST(SceneBuilder, AddsAMaterialByNameAndByIndex)
{
    SceneBuilder builder;
    EXPECT_EQ(builder.add_material(R"({"kind": "metal", "roughness": 0.25})", "steel"), 0);
    builder.add_node(R"({"sphere": {"radius": 2}, "material": "steel"})");
    builder.add_node(R"({"sphere": {"radius": 3}, "material": "#0"})");
    const SceneDescription& scene = builder.scene();
    EXPECT_EQ(scene.materials[0].roughness.value, 0.25f);
    ASSERT_EQ(scene.roots.size(), 2u);
    for (const int root : scene.roots) EXPECT_EQ(scene.nodes[std::size_t(root)].shapes[0].material, 0);
}

TEST(SceneBuilder, ReportsObjectAndPlace)
{
    SceneBuilder builder;
    try {
        builder.add_material(R"({"kind": "metal", "rougness": 0.25})", "steel");
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.file(), "material 'steel'");
        EXPECT_EQ(error.place(), "/rougness");
        EXPECT_NE(error.message().find("did you mean 'roughness'"), std::string::npos);
    }
}

TEST(SceneBuilder, AddsEqualTexturesOnce)
{
    SceneBuilder builder;
    EXPECT_EQ(builder.add_image("a", {std::byte(1)}), builder.add_image("a", {std::byte(2)}));
    for (int i = 0; i < 3; ++i) builder.add_material(R"({"color": {"texture": {"image": "a"}}})", "");
    builder.add_material(R"({"color": {"texture": {"image": "a", "uv_set": 1}}})", "");
    EXPECT_EQ(builder.scene().textures.size(), 2u);
    EXPECT_EQ(builder.scene().images.size(), 1u);
}

TEST(SceneBuilder, WritesWhatItReads)
{
    SceneBuilder builder;
    builder.add_image("a", {std::byte(1)});
    builder.add_material(R"({"kind": "principled", "color": {"texture": {"image": "a"}}, "roughness": 0.5})", "");
    builder.set_environment(R"({"kind": "image", "image": "a"})");
    const std::string material = builder.material_json(0), environment = builder.environment_json();
    builder.set_material(0, material);
    builder.set_environment(environment);
    EXPECT_EQ(builder.material_json(0), material);
    EXPECT_EQ(builder.environment_json(), environment);
    EXPECT_EQ(builder.scene().materials[0].base_color.texture, 0);
    EXPECT_EQ(builder.scene().environment.image, 0);
}

TEST(SceneBuilder, KeepsTheOldObjectAfterAnError)
{
    SceneBuilder builder;
    const int node = builder.add_light(R"({"kind": "point", "position": [1, 2, 3], "intensity": 5})", "lamp");
    builder.set_environment(R"({"kind": "constant", "color": 2})");
    EXPECT_THROW(builder.set_light(node, R"({"kind": "point", "intensity": -1})"), Error);
    EXPECT_THROW(builder.set_environment(R"({"kind": "constant", "colour": 3})"), Error);
    EXPECT_EQ(builder.scene().lights.size(), 1u);
    EXPECT_EQ(builder.scene().lights[0].intensity, (Color{5, 5, 5}));
    EXPECT_EQ(builder.scene().environment.color, (Color{2, 2, 2}));
    builder.set_light(node, R"({"kind": "point", "position": [4, 2, 3], "intensity": 6})");
    EXPECT_EQ(builder.scene().lights[0].intensity, (Color{6, 6, 6}));
    EXPECT_EQ(builder.scene().nodes[std::size_t(node)].parent_from_node.m[0][3], 4);
}

}  // namespace

}  // namespace fathom
