// SPDX-License-Identifier: Apache-2.0
/// Rays through ten thousand instances of one mesh, each rotated and scaled differently, on uneven ground.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "comparison.h"
#include "math/lanes.h"

namespace fathom::bench {
namespace {

constexpr int side = 100;

/// Instances are spaced slightly closer than their bounds.
Mesh in_many_places(Mesh mesh)
{
    GeometryTables& tables = mesh.tables;
    Vec3f low = tables.positions[0], high = low;
    for (const Vec3f& p : tables.positions) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const double width = 0.9 * std::max(high.x - low.x, high.z - low.z), tall = high.y - low.y;
    const Vec3d foot{-0.5 * (low.x + high.x), -double(low.y), -0.5 * (low.z + high.z)};
    tables.shapes[0].flags |= ShapeRecord::only_instanced;
    tables.world_triangles = 0;
    std::uint64_t state = 7;
    const auto uniform = [&state](double from, double to) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return from + (to - from) * double(state >> 40) / double(1 << 24);
    };
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j) {
            const double x = width * (i - 0.5 * side + uniform(-0.2, 0.2)),
                         z = width * (j - 0.5 * side + uniform(-0.2, 0.2));
            const double y = tall * (std::sin(x / (9 * width)) + std::cos(z / (7 * width)));
            const double scale = uniform(0.7, 1.3), angle = uniform(0, 6.2831853), tilt = uniform(-0.1, 0.1);
            const Transform t = Transform::translate({x, y, z}) * Transform::rotate({0, 1, 0}, angle) *
                                Transform::rotate({1, 0, 0}, tilt) * Transform::scale({scale, scale, scale}) *
                                Transform::translate(foot);
            const Transform inverse = t.inverse();
            InstanceRecord instance;
            for (std::size_t k = 0; k < 12; ++k) instance.object_from_render[k] = float(inverse.m[k / 4][k % 4]);
            tables.instances.push_back(instance);
        }
    const double half = 0.5 * side * width;
    mesh.view = {{-0.6 * half, 4 * tall, -0.8 * half}, {0, 0, 0}, {0, 1, 0}, 60};
    return mesh;
}

}  // namespace

void measure_instances(const Mesh& one, const Options& options)
{
    const Mesh mesh = in_many_places(one);
    const Bvh bvh = build(mesh.tables, options);
    const auto embree = build_embree(mesh.tables, options);
    for (const RaySet& set : make_ray_sets(mesh, bvh, options.parts)) {
        const Rates rates = compare(mesh.name, set, {{"instances", bvh, embree.get(), true}}, options);
        std::printf(
            "{\"mesh\": \"%s\", \"kind\": \"%s\", \"isa\": \"%s\", \"threads\": %d, \"instances\": %zu, \"ours\": "
            "%.3f, "
            "\"embree\": %.3f, \"ratio\": %.3f}\n",
            mesh.name.c_str(), set.kind.c_str(), lanes_name, options.threads, mesh.tables.instances.size(),
            median(rates.ours[0]), median(rates.embree[0]), median_ratio(rates.ours[0], rates.embree[0]));
        std::fflush(stdout);
    }
    std::printf(
        "{\"mesh\": \"%s\", \"instances\": %zu, \"build_s\": {\"ours\": %.2f, \"embree\": %.2f}, \"bytes\": {\"ours\": "
        "%zu, "
        "\"embree\": %zu}}\n",
        mesh.name.c_str(), mesh.tables.instances.size(), bvh.statistics().build_s, embree ? embree->build_s() : 0,
        bvh.statistics().bytes, embree ? embree->bytes() : 0);
    std::fflush(stdout);
}

}  // namespace fathom::bench
