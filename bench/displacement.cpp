// SPDX-License-Identifier: Apache-2.0
/// Cost of displacement: a square displaced by an image of a given number of texels per side, beside a mesh of equal
/// triangles. The program for "Displacement" in docs/measurements/scene-changes.md.
///
/// usage: displacement [texels] [displaced | mesh]
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/image.h"
#include "fathom/render.h"

namespace {

using namespace fathom;

float height(int x, int y)
{
    return float(0.5 + 0.25 * std::sin(0.11 * x) * std::cos(0.07 * y));
}

Image heights(int texels)
{
    Image image;
    image.width = image.height = texels;
    image.layers.push_back({"", {"Y"}, {}});
    for (int y = 0; y < texels; ++y)
        for (int x = 0; x < texels; ++x) image.layers[0].pixels.push_back(height(x, y));
    return image;
}

/// A mesh with the number of triangles and the vertex data of a displaced square.
Mesh grid(int parts)
{
    Mesh mesh;
    for (int y = 0; y <= parts; ++y)
        for (int x = 0; x <= parts; ++x) {
            const float u = float(x) / float(parts), v = float(y) / float(parts);
            mesh.positions.push_back({u, v, 0.05f * height(x, y)});
            mesh.normals.push_back({0, 0, 1});
            mesh.uvs[0].push_back({u, 1 - v});
        }
    for (int y = 0; y < parts; ++y)
        for (int x = 0; x < parts; ++x) {
            const auto at = [&](int i, int j) { return std::uint32_t(j * (parts + 1) + i); };
            for (const std::uint32_t v :
                 {at(x, y), at(x + 1, y), at(x, y + 1), at(x, y + 1), at(x + 1, y), at(x + 1, y + 1)})
                mesh.indices.push_back(v);
        }
    return mesh;
}

}  // namespace

int main(int argc, char** argv)
{
    const int texels = argc > 1 ? std::atoi(argv[1]) : 1024;
    const bool displaced = argc < 3 || std::string(argv[2]) == "displaced";
    SceneDescription d;
    d.file = "bench";
    d.cameras.emplace_back();
    d.cameras[0].position = {0.5, 0.5, 2};
    d.nodes.emplace_back();
    d.nodes[0].camera = 0;
    d.roots = {0};
    d.materials.resize(1);
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "fathom_bench_heights.exr";
    write_image(file, heights(texels), {});
    d.images.push_back({"heights", file, {}});
    d.textures.resize(1);
    d.textures[0].image = 0;
    if (displaced) {
        d.materials[0].displacement.height = {0.05f, 0, 0};
        d.nodes[0].shapes.push_back({Rectangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0, ""});
    } else {
        d.meshes.push_back(grid(texels));
        d.nodes[0].shapes.push_back({MeshInstance{0}, 0, ""});
    }
    Warnings warnings;
    std::vector<double> seconds;
    std::size_t triangles = 0;
    for (int i = 0; i < 5; ++i) {
        const Scene scene = Scene::compile(d, "", warnings);
        seconds.push_back(scene.statistics().build_s);
        triangles = scene.statistics().triangles;
    }
    std::filesystem::remove(file);
    std::sort(seconds.begin(), seconds.end());
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    std::printf("%s: %zu triangles, compiled in %.2f s (%.2f to %.2f), peak memory %ld MB\n",
                displaced ? "displaced" : "mesh", triangles, seconds[2], seconds.front(), seconds.back(),
                usage.ru_maxrss / 1024);
    for (const auto& [what, times] : warnings.counts()) std::printf("%s\n", what.c_str());
}
