// SPDX-License-Identifier: Apache-2.0
/// Cost of an edit in a scene of many objects, beside full compilation: the program for "Scene edits" in
/// docs/measurements/scene-changes.md.
///
/// usage: edit [objects] [triangles of each]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "fathom/editable_scene.h"

namespace {

using namespace fathom;

/// A bumpy ball of about the given number of triangles.
Mesh ball(int triangles, int number)
{
    const int n = std::max(2, int(std::sqrt(triangles / 4.0)));
    Mesh mesh;
    mesh.movable = true;
    for (int i = 0; i <= n; ++i)
        for (int k = 0; k < 2 * n; ++k) {
            const double theta = 3.14159265 * i / n, phi = 3.14159265 * k / n;
            const double r = 0.4 + 0.03 * std::sin((7 + number % 5) * theta) * std::cos(5 * phi);
            mesh.positions.push_back({float(r * std::sin(theta) * std::cos(phi)), float(r * std::cos(theta)),
                                      float(r * std::sin(theta) * std::sin(phi))});
        }
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < 2 * n; ++k) {
            const auto at = [&](int row, int column) { return std::uint32_t(row * 2 * n + column % (2 * n)); };
            for (const std::uint32_t v :
                 {at(i, k), at(i + 1, k), at(i, k + 1), at(i, k + 1), at(i + 1, k), at(i + 1, k + 1)})
                mesh.indices.push_back(v);
        }
    return mesh;
}

template <class F>
double milliseconds(const F& f)
{
    const auto start = std::chrono::steady_clock::now();
    f();
    return 1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> v)
{
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
}

/// Time to render 320x240 pixels with 8 samples per pixel on one thread.
double render_milliseconds(const SceneDescription& d)
{
    Warnings warnings;
    RenderSettings settings;
    settings.width = 320, settings.height = 240, settings.threads = 1;
    const RenderJob job(Scene::compile(d, "", warnings), settings);
    Film film(job);
    return milliseconds([&] { render(job, {0, 8}, film); });
}

}  // namespace

int main(int argc, char** argv)
{
    const int objects = argc > 1 ? std::atoi(argv[1]) : 1000, triangles = argc > 2 ? std::atoi(argv[2]) : 1000;
    SceneDescription d;
    d.file = "bench";
    d.cameras.emplace_back();
    d.nodes.emplace_back();
    d.nodes[0].camera = 0;
    d.roots = {0};
    d.cameras[0].position = {0, 0, 40};
    const int side = std::max(1, int(std::cbrt(objects)));
    const auto place = [&](int i, double off) {
        const int row = i / side, layer = row / side;
        return Transform::translate({i % side + off, double(row % side), double(layer)});
    };
    for (int i = 0; i < objects; ++i) {
        d.meshes.push_back(ball(triangles, i));
        Node node;
        node.movable = true;
        node.parent_from_node = place(i, 0);
        node.shapes.push_back({MeshInstance{i}, -1, ""});
        d.roots.push_back(int(d.nodes.size()));
        d.nodes.push_back(node);
    }
    Warnings warnings;
    std::vector<double> whole, moved, bent, all, slower;
    SceneDescription still = d;
    for (Mesh& mesh : still.meshes) mesh.movable = false;
    for (Node& node : still.nodes) node.movable = false;
    still.environment.kind = d.environment.kind = EnvironmentKind::constant;
    EditableScene edit(d);
    edit.compile(warnings);
    for (int round = 0; round < 7; ++round) {
        slower.push_back(render_milliseconds(d) / render_milliseconds(still));
        whole.push_back(milliseconds([&] { Scene::compile(d, "", warnings); }));
        const int i = 1 + (round * 37) % objects;
        moved.push_back(milliseconds([&] {
            edit.set_transform(i, place(i - 1, 0.1 * round));
            edit.compile(warnings);
        }));
        bent.push_back(milliseconds([&] {
            std::vector<Vec3f> positions = d.meshes[std::size_t(i - 1)].positions;
            for (Vec3f& p : positions) p.y *= 1 + 0.01f * float(round);
            edit.set_vertices(i - 1, std::move(positions), {});
            edit.compile(warnings);
        }));
        all.push_back(milliseconds([&] {
            for (int k = 0; k < objects; ++k) edit.set_transform(k + 1, place(k, 0.01 * (k % 7) * round));
            edit.compile(warnings);
        }));
    }
    std::printf(
        "%d objects of %zu triangles: the whole scene %.1f ms; one moved %.2f ms, one bent %.2f ms, all moved "
        "%.2f ms; a picture takes %.2f times as long as if nothing were movable\n",
        objects, d.meshes[0].indices.size() / 3, median(whole), median(moved), median(bent), median(all),
        median(slower));
}
