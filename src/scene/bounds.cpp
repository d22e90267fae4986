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

/// Exact for an ellipsoid or ellipse: the points center + a cos + b sin (+ c ...) with half-axes a, b, c.
void add_ellipsoid(Bounds& bounds, Vec3d center, Vec3d a, Vec3d b, Vec3d c)
{
    const auto reach = [](double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); };
    const Vec3d extent{reach(a.x, b.x, c.x), reach(a.y, b.y, c.y), reach(a.z, b.z, c.z)};
    add_point(bounds, center - extent);
    add_point(bounds, center + extent);
}

void add_sphere(Bounds& bounds, const Transform& t, Vec3d center, double r)
{
    add_ellipsoid(bounds, t.point(center), t.vector({r, 0, 0}), t.vector({0, r, 0}), t.vector({0, 0, r}));
}

void add_disk(Bounds& bounds, const Transform& t, const Disk& disk)
{
    const Vec3d n = normalize(disk.normal);
    const Vec3d u = normalize(cross(n, std::abs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0})), v = cross(n, u);
    add_ellipsoid(bounds, t.point(disk.center), t.vector(u * disk.radius), t.vector(v * disk.radius), {});
}

void add_box(Bounds& bounds, const Transform& t, Vec3d min, Vec3d max)
{
    for (int i = 0; i < 8; ++i)
        add_point(bounds, t.point({i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z}));
}

/// Boxes of the meshes in their own space, found when first asked for.
class MeshBoxes {
public:
    explicit MeshBoxes(const SceneDescription& scene)
        : scene_(scene), boxes_(scene.meshes.size()), known_(scene.meshes.size())
    {
    }

    void add(Bounds& bounds, const Transform& t, int index)
    {
        if (index < 0 || index >= int(scene_.meshes.size())) return;
        const auto& positions = scene_.meshes[std::size_t(index)].positions;
        // Exact for what a few instances show; the corners of the mesh's box for a forest.
        if (positions.size() <= budget_) {
            budget_ -= positions.size();
            for (Vec3f p : positions) add_point(bounds, t.point({p.x, p.y, p.z}));
            return;
        }
        Bounds& box = boxes_[std::size_t(index)];
        if (!known_[std::size_t(index)])
            for (Vec3f p : positions) add_point(box, {p.x, p.y, p.z});
        known_[std::size_t(index)] = true;
        if (!box.empty) add_box(bounds, t, box.min, box.max);
    }

private:
    const SceneDescription& scene_;
    std::vector<Bounds> boxes_;
    std::vector<bool> known_;
    std::size_t budget_ = 20'000'000;
};

void add_shape(Bounds& bounds, MeshBoxes& meshes, const Transform& t, const Shape& shape)
{
    if (const auto* mesh = std::get_if<MeshInstance>(&shape.geometry)) {
        meshes.add(bounds, t, mesh->mesh);
    } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        add_sphere(bounds, t, sphere->center, sphere->radius);
        if (sphere->center_end) add_sphere(bounds, t, *sphere->center_end, sphere->radius);
    } else if (const auto* rect = std::get_if<Rectangle>(&shape.geometry)) {
        for (int i = 0; i < 4; ++i)
            add_point(bounds, t.point(rect->corner + rect->edge_u * (i & 1) + rect->edge_v * (i >> 1)));
    } else if (const auto* box = std::get_if<Box>(&shape.geometry)) {
        add_box(bounds, t, box->min, box->max);
    } else if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
        add_disk(bounds, t, *disk);
    }
}

void add_node(Bounds& bounds, const SceneDescription& scene, MeshBoxes& meshes, const Transform& parent, int index,
              int depth)
{
    if (index < 0 || index >= int(scene.nodes.size()) || depth > 256) return;
    const Node& node = scene.nodes[index];
    const Transform t = parent * node.parent_from_node;
    for (const Shape& shape : node.shapes) add_shape(bounds, meshes, t, shape);
    for (int child : node.children) add_node(bounds, scene, meshes, t, child, depth + 1);
}

}  // namespace

Bounds world_bounds(const SceneDescription& scene)
{
    Bounds bounds;
    MeshBoxes meshes(scene);
    for (int root : scene.roots) add_node(bounds, scene, meshes, {}, root, 0);
    return bounds;
}

}  // namespace fathom
