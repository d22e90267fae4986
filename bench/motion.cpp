// SPDX-License-Identifier: Apache-2.0
/// Rays through a static mesh, and through it in motion by 5 % of its size: with each vertex on a line of its own, or
/// as an instance that is translated and rotated by 3 degrees. All use the same rays, each at a time of its own.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "comparison.h"
#include "math/lanes.h"

namespace fathom::bench {
namespace {

struct Size {
    double diagonal = 0;
    Vec3f center;
};

Size size_of(const GeometryTables& tables)
{
    Vec3f low = tables.positions[0], high = low;
    for (const Vec3f& p : tables.positions) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const double x = high.x - low.x, y = high.y - low.y, z = high.z - low.z;
    return {std::sqrt(x * x + y * y + z * z), {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2}};
}

GeometryTables with_moving_vertices(GeometryTables tables)
{
    const Size size = size_of(tables);
    const std::size_t n = tables.positions.size();
    const float way = float(0.05 * size.diagonal), wave = float(20 / size.diagonal);
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3f p = tables.positions[i];
        const float a = p.x * wave, b = p.y * wave + p.z * wave;
        tables.positions.push_back(
            {p.x + way * std::cos(a) * std::cos(b), p.y + way * std::sin(a) * std::cos(b), p.z + way * std::sin(b)});
    }
    tables.shapes[0].moving_vertices = std::uint32_t(n);
    tables.vertex_times = {0, 1};
    tables.shutter_close = 1;
    return tables;
}

GeometryTables placed(GeometryTables tables, bool moving)
{
    const Size size = size_of(tables);
    tables.shapes[0].flags |= ShapeRecord::only_instanced;
    tables.world_triangles = 0;
    InstanceRecord instance;
    instance.object_from_render = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    if (moving) {
        const double half = 3 * 3.14159265358979 / 360;
        PoseRecord from, to;
        from.rotation[3] = 1;
        for (int i : {0, 3, 5}) from.stretch[i] = to.stretch[i] = 1;
        to.time = 1;
        to.translation[0] = to.translation[2] = float(0.05 * size.diagonal / std::sqrt(2.0));
        to.rotation[1] = float(std::sin(half)), to.rotation[3] = float(std::cos(half));
        from.turns = float(half / 6.28318530717958);
        from.inverse_sine = float(1 / std::sin(half));
        tables.poses = {from, to};
        instance.poses = 2;
        tables.shutter_close = 1;
    }
    tables.instances = {instance};
    return tables;
}

struct Case {
    const char* name;
    GeometryTables tables;
    Bvh bvh;
    std::unique_ptr<EmbreeCaster> embree;
};

}  // namespace

void measure_motion(const Mesh& mesh, const Options& options)
{
    std::vector<std::unique_ptr<Case>> cases;
    const auto add = [&](const char* name, GeometryTables tables) {
        cases.push_back(std::make_unique<Case>(Case{name, std::move(tables), {}, {}}));
        Case& added = *cases.back();
        added.bvh = build(added.tables, options);
        added.embree = build_embree(added.tables, options);
    };
    add("still", mesh.tables);
    add("moving vertices", with_moving_vertices(mesh.tables));
    add("placed", placed(mesh.tables, false));
    add("placed, moving", placed(mesh.tables, true));
    std::vector<Scene> scenes;
    for (const auto& c : cases) scenes.push_back({c->name, c->bvh, c->embree.get(), !c->tables.instances.empty()});
    if (options.details)
        for (const auto& c : cases) {
            const BvhStatistics& s = c->bvh.statistics();
            std::fprintf(stderr, "%s, %s: cost %.2f, %zu nodes of %.1f children, %zu leaves of %.1f\n",
                         mesh.name.c_str(), c->name, s.cost, s.nodes,
                         double(s.children) / double(std::max<std::size_t>(1, s.nodes)), s.leaves,
                         double(s.leaf_primitives) / double(std::max<std::size_t>(1, s.leaves)));
        }

    for (RaySet& set : make_ray_sets(mesh, cases[0]->bvh, options.parts)) {
        std::uint32_t x = 1;
        set.time.resize(set.t_max.size());
        for (float& time : set.time) time = float((x = x * 747796405u + 2891336453u) >> 8) * 0x1p-24f;
        const Rates rates = compare(mesh.name, set, scenes, options);
        for (std::size_t c = 0; c < cases.size(); ++c)
            std::printf(
                "{\"mesh\": \"%s\", \"kind\": \"%s\", \"isa\": \"%s\", \"threads\": %d, \"case\": \"%s\", "
                "\"ours\": %.3f, \"embree\": %.3f, \"ratio\": %.3f, \"ours_times_still\": %.3f, "
                "\"embree_times_still\": %.3f}\n",
                mesh.name.c_str(), set.kind.c_str(), lanes_name, options.threads, cases[c]->name, median(rates.ours[c]),
                median(rates.embree[c]), median_ratio(rates.ours[c], rates.embree[c]),
                median_ratio(rates.ours[c], rates.ours[0]), median_ratio(rates.embree[c], rates.embree[0]));
        std::fflush(stdout);
    }
    const double triangles = mesh.tables.triangle_count();
    for (const auto& c : cases)
        std::printf(
            "{\"mesh\": \"%s\", \"case\": \"%s\", \"build_s\": {\"ours\": %.2f, \"embree\": %.2f}, "
            "\"bytes_per_triangle\": {\"ours\": %.1f, \"embree\": %.1f}}\n",
            mesh.name.c_str(), c->name, c->bvh.statistics().build_s, c->embree ? c->embree->build_s() : 0,
            double(c->bvh.statistics().bytes) / triangles, c->embree ? double(c->embree->bytes()) / triangles : 0);
    std::fflush(stdout);
}

}  // namespace fathom::bench
