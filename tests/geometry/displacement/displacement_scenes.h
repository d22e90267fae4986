// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Scenes with displacement, and their triangles after compilation.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <tuple>

#include "compile/scene_data.h"
#include "fathom/image.h"
#include "fathom/render.h"

namespace fathom::test {

/// A one-channel image file that is removed at the end.
class HeightFile {
public:
    HeightFile(int width, int height, const std::function<double(double, double)>& value)
    {
        static int count = 0;
        path = std::filesystem::temp_directory_path() /
               ("fathom_displacement_" + std::to_string(getpid()) + "_" + std::to_string(count++) + ".exr");
        Image image;
        image.width = width;
        image.height = height;
        image.layers.push_back({"", {"Y"}, {}});
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                image.layers[0].pixels.push_back(float(value((x + 0.5) / width, (y + 0.5) / height)));
        write_image(path, image, {});
    }
    ~HeightFile() { std::filesystem::remove(path); }

    std::filesystem::path path;
};

inline HeightFile random_heights(int size)
{
    std::mt19937 random(7);
    return HeightFile(size, size, [&](double, double) { return std::uniform_real_distribution<double>(0, 1)(random); });
}

/// A material with a constant displacement, or a texture times a constant.
inline Material displacing(float height, int texture = -1)
{
    Material m;
    m.displacement.height = {height, texture, 0};
    return m;
}

struct TestScene {
    SceneDescription d;

    TestScene()
    {
        d.file = "test";
        d.nodes.emplace_back();
        d.roots = {0};
        d.cameras.emplace_back();
        d.cameras[0].position = {0.5, 0.5, 5};
        d.cameras[0].look_at = {0.5, 0.5, 0};
        d.cameras[0].fov_y = 0.05;
        d.nodes[0].camera = 0;
    }
    int add_picture(const HeightFile& file)
    {
        d.images.push_back({"heights", file.path, {}});
        Texture t;
        t.image = int(d.images.size()) - 1;
        t.wrap_u = t.wrap_v = Wrap::clamp;
        d.textures.push_back(t);
        return int(d.textures.size()) - 1;
    }
    int add_material(const Material& m)
    {
        d.materials.push_back(m);
        return int(d.materials.size()) - 1;
    }
    template <class Geometry>
    void add(const Geometry& geometry, int material)
    {
        d.nodes[0].shapes.push_back({geometry, material, ""});
    }
    void add_mesh(Mesh mesh, int material)
    {
        d.meshes.push_back(std::move(mesh));
        add(MeshInstance{int(d.meshes.size()) - 1}, material);
    }
    Scene compiled() const
    {
        Warnings warnings;
        Scene scene = Scene::compile(d, "", warnings);
        for (const auto& [what, times] : warnings.counts()) ADD_FAILURE() << what;
        return scene;
    }
};

/// World-space triangles of a compiled scene; a quad gives the two triangles it was joined from.
inline std::vector<std::array<Vec3d, 3>> triangles_of(const Scene& scene)
{
    const SceneTables& t = *scene.data().tables;
    const auto in_world = [&](const Vec3d& p) { return p * (1 / t.render_scale) + t.origin; };
    std::vector<std::array<Vec3d, 3>> triangles(t.triangle_count());
    for (std::size_t i = 0; i < t.triangles.size(); ++i)
        triangles[i / 3][i % 3] = in_world(to_double(t.positions[t.triangles[i]]));
    for (const QuadRecord& q : t.quads) {
        const Vec3d corner = to_double(q.corner), u = corner + to_double(q.edge_u), v = corner + to_double(q.edge_v);
        triangles.push_back({in_world(corner), in_world(u), in_world(v)});
        triangles.push_back({in_world(u), in_world(u + v - corner), in_world(v)});
    }
    return triangles;
}

/// Number of edges without a neighboring triangle that runs along them in the opposite direction.
inline std::size_t open_edges(const std::vector<std::array<Vec3d, 3>>& triangles)
{
    const auto key = [](Vec3d p) { return std::tuple(p.x + 0.0, p.y + 0.0, p.z + 0.0); };
    using Place = decltype(key({}));
    std::map<std::pair<Place, Place>, int> count;
    for (const auto& t : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const Place a = key(t[k]), b = key(t[(k + 1) % 3]);
            if (a == b) continue;
            ++count[{a, b}];
            --count[{b, a}];
        }
    return std::size_t(std::count_if(count.begin(), count.end(), [](const auto& c) { return c.second > 0; }));
}

inline Image rendered(const Scene& scene, std::vector<Aov> aovs, int size = 3, std::uint64_t samples = 4)
{
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.aovs = std::move(aovs);
    const RenderJob job(scene, settings);
    Film film(job);
    render(job, {0, samples}, film);
    return film.image(false, false);
}

/// A sphere of rings and sectors with a seam in its texture coordinates and one vertex per sector at the poles.
inline Mesh ball(double radius, int rings, int sectors)
{
    Mesh mesh;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i <= sectors; ++i) {
            const double phi = 2 * std::numbers::pi * (i % sectors) / sectors, theta = std::numbers::pi * j / rings;
            // The sine is exactly 0 at the poles; otherwise their vertices would have different positions.
            const double sine = j % rings == 0 ? 0 : std::sin(theta);
            const Vec3d n{sine * std::cos(phi), std::cos(theta), -sine * std::sin(phi)};
            mesh.positions.push_back({float(radius * n.x), float(radius * n.y), float(radius * n.z)});
            mesh.normals.push_back({float(n.x), float(n.y), float(n.z)});
            mesh.uvs[0].push_back({float(i) / float(sectors), float(j) / float(rings)});
        }
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < sectors; ++i) {
            const auto a = std::uint32_t(j * (sectors + 1) + i), b = a + 1, c = a + std::uint32_t(sectors) + 1;
            if (j > 0) mesh.indices.insert(mesh.indices.end(), {a, c, b});
            if (j + 1 < rings) mesh.indices.insert(mesh.indices.end(), {b, c, c + 1});
        }
    return mesh;
}

inline const Rectangle unit_square{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

}  // namespace fathom::test
