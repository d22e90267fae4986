// SPDX-License-Identifier: Apache-2.0
#include "fathom/scene_digest.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

SceneDescription made_scene()
{
    SceneDescription scene;
    for (const char* name : {"wall", "floor"}) scene.materials.emplace_back().name = name;
    scene.textures.emplace_back().name = "tiles";
    scene.lights.emplace_back().name = "lamp";
    scene.lights[0].kind = LightKind::directional;
    return scene;
}

std::string difference(const SceneDescription& now)
{
    return scene_digest_difference(scene_digest(made_scene()), scene_digest(now));
}

TEST(SceneDigest, NamesTheDifferences)
{
    EXPECT_EQ(difference(made_scene()), "");
    SceneDescription now = made_scene();
    now.materials[0].base_color.value = {1, 0.5f, 0.25f};
    EXPECT_EQ(difference(now), "material 'wall': color");
    now.lights[0].intensity.g = 3;
    now.lights[0].angle = 1;
    EXPECT_EQ(difference(now), "light 'lamp': angle_deg, intensity; material 'wall': color");
    now = made_scene();
    now.materials[1].base_color.texture = 0;
    EXPECT_EQ(difference(now), "material 'floor': color");
    now = made_scene();
    now.materials[1].name = "ground\twet";
    EXPECT_EQ(difference(now), "material 'ground wet' is new; material 'floor' is gone");
    now = made_scene();
    now.environment.kind = EnvironmentKind::constant;
    EXPECT_EQ(difference(now), "environment: kind");
}

TEST(SceneDigest, ListIsShort)
{
    SceneDescription now = made_scene();
    for (int i = 0; i < 10; ++i) now.materials.emplace_back().name = std::to_string(i);
    EXPECT_EQ(difference(now),
              "material '0' is new; material '1' is new; material '2' is new; material '3' is new; and 6 more");
}

/// A texture with another index because of its position in the list is still equal.
TEST(SceneDigest, NamesCountNotIndices)
{
    SceneDescription before = made_scene(), now = made_scene();
    before.materials[0].base_color.texture = 0;
    now.textures.insert(now.textures.begin(), Texture())->name = "other";
    now.materials[0].base_color.texture = 1;
    EXPECT_EQ(scene_digest_difference(scene_digest(before), scene_digest(now)), "texture 'other' is new");
}

}  // namespace
}  // namespace fathom
