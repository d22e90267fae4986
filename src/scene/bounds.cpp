#include <algorithm>

#include "fathom/load.h"

namespace fathom {

namespace {

void add_point(Bounds& bounds, Vec3d p)
{
    if (!std::isfinite(p.x + p.y + p.z)) return;
    if (bounds.empty) {
        bounds = {p, p, false};
        return;
    }
    bounds.min = {std::min(bounds.min.x, p.x), std::min(bounds.min.y, p.y), std::min(bounds.min.z, p.z)};
    bounds.max = {std::max(bounds.max.x, p.x), std::max(bounds.max.y, p.y), std::max(bounds.max.z, p.z)};
}

/// The box around center +- half-axes, each mapped: exact for boxes, safe for spheres and disks.
void add_extent(Bounds& bounds, const Transform& t, Vec3d center, double r)
{
    for (int i = 0; i < 8; ++i)
        add_point(bounds, t.point(center + Vec3d{i & 1 ? r : -r, i & 2 ? r : -r, i & 4 ? r : -r}));
}

void add_shape(Bounds& bounds, const SceneDescription& scene, const Transform& t, const Shape& shape)
{
    if (const auto* mesh = std::get_if<MeshInstance>(&shape.geometry)) {
        if (mesh->mesh < 0 || mesh->mesh >= int(scene.meshes.size())) return;
        for (Vec3f p : scene.meshes[mesh->mesh].positions) add_point(bounds, t.point({p.x, p.y, p.z}));
    } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        add_extent(bounds, t, sphere->center, std::abs(sphere->radius));
        if (sphere->center_end) add_extent(bounds, t, *sphere->center_end, std::abs(sphere->radius));
    } else if (const auto* rect = std::get_if<Rectangle>(&shape.geometry)) {
        for (int i = 0; i < 4; ++i)
            add_point(bounds, t.point(rect->corner + rect->edge_u * (i & 1) + rect->edge_v * (i >> 1)));
    } else if (const auto* box = std::get_if<Box>(&shape.geometry)) {
        for (int i = 0; i < 8; ++i)
            add_point(bounds, t.point({i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y,
                                       i & 4 ? box->max.z : box->min.z}));
    } else if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
        add_extent(bounds, t, disk->center, disk->radius);
    }
}

void add_node(Bounds& bounds, const SceneDescription& scene, const Transform& parent, int index, int depth)
{
    if (index < 0 || index >= int(scene.nodes.size()) || depth > 256) return;
    const Node& node = scene.nodes[index];
    const Transform t = parent * node.parent_from_node;
    for (const Shape& shape : node.shapes) add_shape(bounds, scene, t, shape);
    for (int child : node.children) add_node(bounds, scene, t, child, depth + 1);
}

}  // namespace

Bounds world_bounds(const SceneDescription& scene)
{
    Bounds bounds;
    for (int root : scene.roots) add_node(bounds, scene, {}, root, 0);
    return bounds;
}

}  // namespace fathom
