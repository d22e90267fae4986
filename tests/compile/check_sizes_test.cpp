// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "fathom/error.h"
#include "fathom/render.h"

// Numbers that are finite but too large to render.
namespace fathom {
namespace {

/// A sphere in a node, a mesh in a node with several instances, and a camera that sees both.
SceneDescription small_scene()
{
    SceneDescription scene;
    scene.file = "s.json";
    Mesh mesh;
    for (int i = 0; i < 3000; ++i)
        for (const Vec3f p : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}}) {
            mesh.indices.push_back(std::uint32_t(mesh.positions.size()));
            mesh.positions.push_back(p);
        }
    scene.meshes.push_back(mesh);
    scene.nodes.resize(4);
    scene.nodes[0].name = "ball";
    scene.nodes[0].shapes.push_back({Sphere{{0, 0, 0}, 1, {}}, -1, ""});
    for (std::size_t i : {1, 2}) scene.nodes[i].shapes.push_back({MeshInstance{0}, -1, ""});
    scene.nodes[3].camera = 0;
    Camera camera;
    camera.name = "main";
    camera.position = {0, 0, 5};
    scene.cameras.push_back(camera);
    scene.roots = {0, 1, 2, 3};
    return scene;
}

std::string error_of(const std::function<void(SceneDescription&)>& change)
{
    SceneDescription scene = small_scene();
    change(scene);
    try {
        Warnings warnings;
        const Scene compiled = Scene::compile(scene, "", warnings);
        RenderSettings settings;
        settings.width = settings.height = 16;
        const RenderJob job(compiled, settings);
        Film film(job);
        render(job, {0, 2}, film);
        if (film.invalid_samples() > 0) return "samples that are no numbers";
        for (const auto& [message, times] : warnings.counts()) return message;
    } catch (const Error& error) {
        EXPECT_EQ(error.file(), "s.json");
        return error.place() + ": " + error.message();
    }
    return "rendered";
}

TEST(CheckSizes, TheSceneItselfRenders)
{
    EXPECT_EQ(error_of([](SceneDescription&) {}), "rendered");
}

TEST(CheckSizes, Cameras)
{
    const auto error = [](const std::function<void(Camera&)>& change) {
        return error_of([&](SceneDescription& scene) { change(scene.cameras[0]); });
    };
    for (const double huge : {1e16, 1e22, 1e30, 1e200, 1.7e308}) {
        EXPECT_EQ(error([&](Camera& c) { c.position.x = huge; }).rfind("camera 'main': a coordinate is 1", 0), 0u)
            << huge;
        EXPECT_EQ(error([&](Camera& c) { c.look_at.y = -huge; }).rfind("camera 'main': a coordinate is -1", 0), 0u);
        EXPECT_EQ(error([&](Camera& c) { c.aperture = huge; }).rfind("camera 'main': the aperture is 1", 0), 0u);
        EXPECT_EQ(error([&](Camera& c) { c.focus_distance = huge; }).rfind("camera 'main': the focus distance is 1", 0),
                  0u);
        EXPECT_EQ(error([&](Camera& c) { c.shutter_close = huge; }).rfind("camera 'main': the shutter closes at 1", 0),
                  0u);
        EXPECT_EQ(error([&](Camera& c) { c.shutter_open = -huge; }).rfind("camera 'main': the shutter opens at -1", 0),
                  0u);
        EXPECT_EQ(error([&](Camera& c) {
                      c.kind = CameraKind::orthographic, c.height = huge;
                  }).rfind("camera 'main': the height is 1", 0),
                  0u);
    }
    EXPECT_EQ(error([](Camera& c) { c.aperture = 1e12; }),
              "camera 'main': the aperture is 1e+12 m, which is too large compared with the scene");
    EXPECT_EQ(error([](Camera& c) { c.shutter_open = 1e9, c.shutter_close = 1e9 + 1; }),
              "camera 'main': the shutter opens at 1e+09 s and closes at 1e+09 s, which are equal in single precision; "
              "use times closer to 0");
    EXPECT_EQ(error([](Camera& c) { c.look_at = c.position; }),
              "camera 'main': its position and its look_at point are the same");
    EXPECT_EQ(error([](Camera& c) { c.up = {0, 0, 0}; }), "camera 'main': 'up' is not a direction");
    // Large distances and late shutter times alone are valid.
    EXPECT_EQ(error([](Camera& c) { c.look_at = {0, 0, -1e8}; }), "rendered");
    EXPECT_EQ(error([](Camera& c) { c.shutter_open = 1e6, c.shutter_close = 1e6 + 1; }), "rendered");
}

TEST(CheckSizes, Nodes)
{
    const auto moved = [](std::size_t node, double x) {
        return error_of([=](SceneDescription& s) { s.nodes[node].parent_from_node = Transform::translate({x, 0, 0}); });
    };
    for (const double huge : {1e16, 1e22, 1e30, 1e200}) {
        EXPECT_EQ(moved(0, huge).rfind("nodes[0] 'ball': places its shape 1", 0), 0u) << moved(0, huge);
        EXPECT_EQ(moved(2, -huge).rfind("nodes[2]: places its shape 1", 0), 0u) << moved(2, -huge);
    }
    EXPECT_EQ(moved(0, 1e6), "rendered");
    // Products of transforms overflow although none of the factors does.
    EXPECT_EQ(error_of([](SceneDescription& scene) {
                  Node above;
                  above.children = {0};
                  above.parent_from_node = scene.nodes[0].parent_from_node = Transform::scale({1e200, 1e200, 1e200});
                  scene.roots[0] = int(scene.nodes.size());
                  scene.nodes.push_back(above);
              }),
              "nodes[0] 'ball': places its shape beyond the range of floating-point numbers");
    EXPECT_EQ(error_of([](SceneDescription& scene) {
                  std::get<Sphere>(scene.nodes[0].shapes[0].geometry).radius = 1.7e308;
              }).rfind("nodes[0] 'ball': ", 0),
              0u);
    EXPECT_EQ(error_of([](SceneDescription& scene) { scene.meshes[0].positions[5].y = 1e30f; }),
              "nodes[1]: a coordinate of its shape is 1e+30; the limit is 1e+15");
    EXPECT_EQ(error_of([](SceneDescription& scene) {
                  std::get<Sphere>(scene.nodes[0].shapes[0].geometry).center_end = Vec3d{1e9, 0, 0};
                  scene.cameras[0].shutter_open = 1e7, scene.cameras[0].shutter_close = 1e7 + 1;
              }).rfind("nodes[0] 'ball': places its shape 1e+16 m away", 0),
              0u);
}

TEST(CheckSizes, WhatIsScaledToNothingIsLeftOut)
{
    for (const double tiny : {0.0, 1e-30, 1e-300})
        EXPECT_EQ(error_of([=](SceneDescription& scene) {
                      scene.nodes[2].parent_from_node = Transform::scale({tiny, tiny, tiny});
                  }),
                  "s.json: shapes that are scaled to almost zero size are ignored");
}

TEST(CheckSizes, Lights)
{
    EXPECT_EQ(error_of([](SceneDescription& scene) {
                  scene.materials.resize(1);
                  scene.materials[0].emission.radiance.value = {1, 1e30f, 1};
                  scene.nodes[0].shapes[0].material = 0;
              }),
              "materials[0].emission: has a brightness of 1e+30; up to 1e+20 can be rendered");
    EXPECT_EQ(error_of([](SceneDescription& scene) {
                  scene.lights.resize(1);
                  scene.lights[0].intensity = {1e38f, 0, 0};
                  scene.nodes[1].light = 0;
              }),
              "lights[0]: has a brightness of 1e+38; up to 1e+20 can be rendered");
    EXPECT_EQ(error_of([](SceneDescription& scene) {
                  scene.environment.kind = EnvironmentKind::constant;
                  scene.environment.color.b = std::numeric_limits<float>::max();
              }).rfind("environment: has a brightness of 3.4", 0),
              0u);
}

}  // namespace
}  // namespace fathom
