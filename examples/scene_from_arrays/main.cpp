// SPDX-License-Identifier: Apache-2.0
/// A scene from arrays: a triangle mesh, a material, a lamp and a camera, all from std::vector, as programs that
/// compute geometry have them. The mesh is a height field, sin(r) / r, with normals and vertex colors.
///
/// usage: scene_from_arrays [FILE]      (default scene-from-arrays.png)
#include <fathom/error.h>
#include <fathom/render.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

constexpr int side = 128;          // vertices along each edge
constexpr double half_width = 10;  // meters

double height(double x, double z)
{
    const double r = std::hypot(x, z);
    return r > 0 ? 3 * std::sin(r) / r : 3;
}

/// A triangle is three indices, counter-clockwise seen from its outside. Normals and colors are optional: empty, or one
/// per vertex. A mesh without normals is flat-shaded.
fathom::Mesh height_field()
{
    std::vector<fathom::Vec3f> positions, normals;
    std::vector<fathom::Vec4f> colors;
    std::vector<std::uint32_t> indices;
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const double x = half_width * (2.0 * column / (side - 1) - 1);
            const double z = half_width * (2.0 * row / (side - 1) - 1);
            const double y = height(x, z), step = 1e-3;
            const fathom::Vec3d slope = {(height(x - step, z) - height(x + step, z)) / (2 * step), 1,
                                         (height(x, z - step) - height(x, z + step)) / (2 * step)};
            const float share = float((y + 0.7) / 3.7);
            positions.push_back(fathom::to_float({x, y, z}));
            normals.push_back(fathom::to_float(fathom::normalize(slope)));
            colors.push_back({0.1f + 0.8f * share, 0.3f, 0.8f - 0.7f * share, 1});
        }
    for (std::uint32_t row = 0; row + 1 < side; ++row)
        for (std::uint32_t column = 0; column + 1 < side; ++column) {
            const std::uint32_t corner = row * side + column, below = corner + side;
            indices.insert(indices.end(), {corner, below, corner + 1, corner + 1, below, below + 1});
        }
    fathom::Mesh mesh;
    mesh.name = "height field";
    mesh.positions = positions, mesh.normals = normals, mesh.colors = colors, mesh.indices = indices;
    return mesh;
}

fathom::SceneDescription scene_from_arrays()
{
    fathom::SceneDescription scene;
    scene.meshes.push_back(height_field());

    fathom::Material surface, lamp;
    surface.name = "surface";
    surface.kind = fathom::MaterialKind::plastic;
    surface.base_color.value = {1, 1, 1};
    surface.use_vertex_color = true;  // base color times the mesh's colors
    surface.roughness.value = 0.4f;
    lamp.name = "lamp";
    lamp.kind = fathom::MaterialKind::none;       // reflects nothing
    lamp.emission.radiance.value = {25, 23, 20};  // radiance
    scene.materials = {surface, lamp};

    // Any shape with an emissive material is a light. A rectangle shines along cross(edge_u, edge_v), here downwards.
    fathom::Node world;
    world.shapes.push_back({fathom::MeshInstance{0}, 0, "height field"});
    world.shapes.push_back({fathom::Rectangle{{-8, 12, -4}, {6, 0, 0}, {0, 0, 6}}, 1, "lamp"});
    world.camera = 0;
    scene.nodes = {world};
    scene.roots = {0};

    fathom::Camera camera;
    camera.position = {14, 11, 18};
    camera.look_at = {0, 0, 0};
    camera.fov_y = 0.6;  // radians
    scene.cameras = {camera};
    scene.environment.kind = fathom::EnvironmentKind::constant;
    scene.environment.color = {0.15f, 0.17f, 0.2f};
    return scene;
}

}  // namespace

int main(int argc, char** argv)
try {
    fathom::Warnings warnings;
    const fathom::Scene scene = fathom::Scene::compile(scene_from_arrays(), "", warnings);
    for (const auto& [message, times] : warnings.counts()) std::fprintf(stderr, "warning: %s\n", message.c_str());

    fathom::RenderSettings settings;
    settings.width = 320, settings.height = 240;
    const fathom::RenderJob job(scene, settings);
    fathom::Film film(job);
    fathom::render(job, {0, 32}, film);

    fathom::WriteOptions options;
    options.display.tonemap = fathom::Tonemap::khronos_neutral;
    const char* file = argc > 1 ? argv[1] : "scene-from-arrays.png";
    fathom::write_image(file, film.image(false, false), options);
    std::printf("%s: %zu triangles\n", file, scene.statistics().triangles);
} catch (const fathom::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
