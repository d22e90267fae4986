// SPDX-License-Identifier: Apache-2.0
#include "geometry/compile/instancing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fathom/error.h"
#include "scene/motion.h"

namespace fathom {

bool is_similarity(const Transform& t, double& factor)
{
    const Vec3d x = t.vector({1, 0, 0}), y = t.vector({0, 1, 0}), z = t.vector({0, 0, 1});
    factor = length(x);
    const double tolerance = 1e-5 * factor * factor;
    return std::abs(length(y) - factor) * factor <= tolerance && std::abs(length(z) - factor) * factor <= tolerance &&
           std::abs(dot(x, y)) <= tolerance && std::abs(dot(y, z)) <= tolerance && std::abs(dot(x, z)) <= tolerance;
}

std::uint32_t material_index(const SceneTables& tables, const Shape& shape)
{
    return shape.material >= 0 ? std::uint32_t(shape.material) : std::uint32_t(tables.materials.size() - 1);
}

namespace {

/// The curves or points of a shape, or null for other shapes.
const void* set_of(const SceneDescription& scene, const Shape& shape)
{
    if (const auto* c = std::get_if<CurvesInstance>(&shape.geometry)) return &scene.curves[std::size_t(c->curves)];
    if (const auto* p = std::get_if<PointsInstance>(&shape.geometry)) return &scene.points[std::size_t(p->points)];
    return nullptr;
}

}  // namespace

const void* described_geometry(const SceneDescription& scene, const Shape& shape)
{
    if (const auto* mesh = std::get_if<MeshInstance>(&shape.geometry)) return &scene.meshes[std::size_t(mesh->mesh)];
    const void* set = set_of(scene, shape);
    return set ? set : &shape;
}

const void* shared_geometry(const Compiler& c, const Shape& shape)
{
    const DisplacedShapes::Entry* displaced = c.displaced.find(c.scene, shape);
    return displaced ? &displaced->mesh : described_geometry(c.scene, shape);
}

Instancing::Instancing(const Compiler& c, const FlattenedScene& occurrences) : c_(c), occurrences_(occurrences)
{
    find_vertex_times();
    count_uses();
}

void Instancing::find_vertex_times()
{
    const double open = c_.tables.shutter_open, close = c_.tables.shutter_close;
    std::vector<float> times;
    std::set<const void*> seen;
    const auto look_at = [&](const auto& mesh_or_curves) {
        if (!seen.insert(&mesh_or_curves).second || !moves(mesh_or_curves, open, close)) return;
        moving_.insert(&mesh_or_curves);
        times.insert(times.end(), {c_.tables.shutter_open, c_.tables.shutter_close});
        for (const auto& key : mesh_or_curves.motion)
            if (open < key.time && key.time < close) times.push_back(float(key.time));
    };
    for (const FlattenedShape& p : occurrences_.shapes) {
        if (const auto* m = std::get_if<MeshInstance>(&p.shape->geometry))
            look_at(c_.scene.meshes[std::size_t(m->mesh)]);
        if (const auto* c = std::get_if<CurvesInstance>(&p.shape->geometry))
            look_at(c_.scene.curves[std::size_t(c->curves)]);
    }
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    constexpr std::size_t most = 64;
    if (times.size() > most)
        throw Error(
            c_.scene.file, "",
            fmt::format("meshes and curves have keys at {} times while the shutter is open; at most {} are supported",
                        times.size(), most));
    vertex_times_ = times;
}

bool Instancing::is_instanced(const FlattenedShape& p) const
{
    if (p.movable) return true;
    if (p.motion >= 0) return !moves_straight(p);
    constexpr std::size_t fewest_triangles = 4096;
    if (const Mesh* mesh = c_.mesh_of(*p.shape)) {
        const std::size_t uses = uses_.at(shared_geometry(c_, *p.shape));
        return uses > 1 && mesh->indices.size() / 3 * uses >= fewest_triangles;
    }
    const void* set = set_of(c_.scene, *p.shape);
    if (!set) return false;
    // Sets of many curves or points are instanced like meshes. Under a distorting transform, they are exact only in
    // their own object space.
    double factor;
    return !is_similarity(p.render_from_node, factor) || uses_.at(set) > 1;
}

/// A sphere that a node moves linearly stays a primitive of the world, so that it can be sampled as a light.
bool Instancing::moves_straight(const FlattenedShape& p) const
{
    const auto* sphere = std::get_if<Sphere>(&p.shape->geometry);
    const std::vector<NodeKey>& poses = occurrences_.motions[std::size_t(p.motion)];
    double factor;
    if (!sphere || sphere->center_end || c_.mesh_of(*p.shape) || poses.size() != 2 ||
        !is_similarity(p.render_from_node, factor))
        return false;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (std::abs(poses[1].parent_from_node.m[i][j] - poses[0].parent_from_node.m[i][j]) > 1e-9 * factor)
                return false;
    return true;
}

void Instancing::count_uses()
{
    for (const FlattenedShape& p : occurrences_.shapes)
        if (c_.mesh_of(*p.shape) || set_of(c_.scene, *p.shape)) ++uses_[shared_geometry(c_, *p.shape)];
}

}  // namespace fathom
