#include <algorithm>

#include "fathom/load.h"
#include "scene/bounds.h"

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
        : scene_(scene), boxes_(2 * scene.meshes.size()), known_(2 * scene.meshes.size())
    {
    }

    void add(Bounds& bounds, const Transform& t, int index)
    {
        if (index < 0 || index >= int(scene_.meshes.size())) return;
        const Mesh& mesh = scene_.meshes[std::size_t(index)];
        for (const MeshKey& key : mesh.motion) add_positions(bounds, t, 2 * std::size_t(index), key.positions);
        if (mesh.motion.empty()) add_positions(bounds, t, 2 * std::size_t(index) + 1, mesh.positions);
    }

    const SceneDescription& scene() const { return scene_; }

private:
    void add_positions(Bounds& bounds, const Transform& t, std::size_t index, const std::vector<Vec3f>& positions)
    {
        // Exact for what a few instances show; the corners of the mesh's box for a forest.
        if (positions.size() <= budget_) {
            budget_ -= positions.size();
            for (Vec3f p : positions) add_point(bounds, t.point({p.x, p.y, p.z}));
            return;
        }
        Bounds& box = boxes_[index];
        if (!known_[index])
            for (Vec3f p : positions) add_point(box, {p.x, p.y, p.z});
        known_[index] = index & 1;  // boxes of keys grow with each
        if (!box.empty) add_box(bounds, t, box.min, box.max);
    }

    const SceneDescription& scene_;
    std::vector<Bounds> boxes_;
    std::vector<bool> known_;
    std::size_t budget_ = 20'000'000;
};

/// Of a box of balls the corners: as good as exact where there are many small ones.
void add_balls(Bounds& bounds, const Transform& t, const std::vector<Vec3f>& centers, const std::vector<float>& radii)
{
    Bounds box;
    for (std::size_t i = 0; i < centers.size(); ++i) {
        const Vec3d p{centers[i].x, centers[i].y, centers[i].z}, r{radii[i], radii[i], radii[i]};
        add_point(box, p - r);
        add_point(box, p + r);
    }
    if (!box.empty) add_box(bounds, t, box.min, box.max);
}

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
    } else if (const auto* curves = std::get_if<CurvesInstance>(&shape.geometry)) {
        const Curves& c = meshes.scene().curves[std::size_t(curves->curves)];
        add_balls(bounds, t, c.points, c.radii);
    } else if (const auto* points = std::get_if<PointsInstance>(&shape.geometry)) {
        const Points& p = meshes.scene().points[std::size_t(points->points)];
        add_balls(bounds, t, p.centers, p.radii);
    }
}

void add_node(Bounds& bounds, const SceneDescription& scene, MeshBoxes& meshes, const Transform& parent, int index,
              int depth)
{
    if (index < 0 || index >= int(scene.nodes.size()) || depth > 256) return;
    const Node& node = scene.nodes[std::size_t(index)];
    const auto add_at = [&](const Transform& t) {
        for (const Shape& shape : node.shapes) add_shape(bounds, meshes, t, shape);
        for (int child : node.children) add_node(bounds, scene, meshes, t, child, depth + 1);
    };
    // Between its keys a node may swing out a little further: that does no harm here.
    if (node.motion.empty()) return add_at(parent * node.parent_from_node);
    add_at(parent * node.motion.front().parent_from_node);
    if (node.motion.size() > 1) add_at(parent * node.motion.back().parent_from_node);
}

}  // namespace

Bounds shape_bounds(const SceneDescription& scene, const Shape& shape)
{
    Bounds bounds;
    MeshBoxes meshes(scene);
    add_shape(bounds, meshes, {}, shape);
    return bounds;
}

Bounds world_bounds(const SceneDescription& scene)
{
    Bounds bounds;
    MeshBoxes meshes(scene);
    for (int root : scene.roots) add_node(bounds, scene, meshes, {}, root, 0);
    return bounds;
}

}  // namespace fathom
