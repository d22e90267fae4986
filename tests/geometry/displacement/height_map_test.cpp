// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>

#include "fathom/image.h"
#include "fathom/render.h"

// Tests that bump maps bend normals like a surface with the same heights.
namespace fathom {
namespace {

constexpr int size = 64;

/// Radiance at the center of the square from (0, 0, 0) to (1, 1, 0) with albedo 0.5 and a height map, seen from above
/// under a directional light.
double seen(const std::function<double(double, double)>& height, float scale, Vec3d to_sun)
{
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("fathom_heights_" + std::to_string(getpid()) + ".exr");
    Image heights;
    heights.width = heights.height = size;
    heights.layers.push_back({"", {"Y"}, {}});
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            heights.layers[0].pixels.push_back(float(height((x + 0.5) / size, (y + 0.5) / size)));
    write_image(file, heights, {});

    SceneDescription scene;
    scene.images.push_back({"heights", file, {}});
    scene.textures.resize(1);
    scene.textures[0].image = 0;
    scene.textures[0].height_scale = scale;
    scene.materials.resize(1);
    scene.materials[0].base_color.value = {0.5f, 0.5f, 0.5f};
    scene.materials[0].normal_map.texture = 0;
    scene.nodes.resize(2);
    scene.nodes[0].shapes.push_back({Rectangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0, ""});
    scene.nodes[0].camera = 0;
    scene.cameras.resize(1);
    scene.cameras[0].position = {0.5, 0.5, 5};
    scene.cameras[0].look_at = {0.5, 0.5, 0};
    scene.cameras[0].fov_y = 0.05;
    scene.lights.resize(1);
    scene.lights[0].kind = LightKind::directional;
    scene.lights[0].intensity = {1, 1, 1};
    // Lights emit along -z of their node.
    const Vec3d z = normalize(to_sun), x = normalize(cross({0.1, 1, 0}, z)), y = cross(z, x);
    scene.nodes[1].parent_from_node.m = {{{x.x, y.x, z.x, 0}, {x.y, y.y, z.y, 0}, {x.z, y.z, z.z, 0}}};
    scene.nodes[1].light = 0;
    scene.roots = {0, 1};

    Warnings warnings;
    const Scene compiled = Scene::compile(scene, "", warnings);
    EXPECT_TRUE(warnings.empty());
    std::filesystem::remove(file);
    RenderSettings settings;
    settings.width = settings.height = 3;
    const RenderJob job(compiled, settings);
    Film film(job);
    render(job, {0, 16}, film);
    const Image image = film.image(false, false);
    return image.layers[0].pixels.at(3 * 4);
}

/// Lambertian reflection of the surface z = scale * height, for the given slopes.
double expected(double slope_x, double slope_y, Vec3d to_sun)
{
    return 0.5 / std::numbers::pi * dot(normalize(Vec3d{-slope_x, -slope_y, 1}), normalize(to_sun));
}

TEST(HeightMap, BendsNormalsAsASurfaceOfThoseHeights)
{
    const auto along_u = [](double u, double) { return u; };
    const auto along_v = [](double, double v) { return v; };
    const auto both = [](double u, double v) { return 0.5 * u - 0.25 * v; };
    for (const Vec3d sun : {Vec3d{0, 0, 1}, Vec3d{1, 0, 1}, Vec3d{0, 1, 1}, Vec3d{-1, 0.5, 2}}) {
        EXPECT_NEAR(seen(along_u, 0.5f, sun), expected(0.5, 0, sun), 1e-4);
        // Images are upright on rectangles: v grows downwards.
        EXPECT_NEAR(seen(along_v, 0.5f, sun), expected(0, -0.5, sun), 1e-4);
        EXPECT_NEAR(seen(both, 0.8f, sun), expected(0.4, 0.2, sun), 1e-4);
    }
}

}  // namespace
}  // namespace fathom
