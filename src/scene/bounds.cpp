// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "fathom/load.h"
#include "scene/bounds.h"
#include "scene/displacement.h"
#include "scene/motion.h"

namespace fathom {

namespace {

/// Accumulates a bounding box.
struct BoxSink {
    Bounds bounds;

    void point(Vec3d p)
    {
        if (!std::isfinite(p.x + p.y + p.z)) return;
        if (bounds.empty) {
            bounds = {p, p, false};
            return;
        }
        bounds.min = {std::min(bounds.min.x, p.x), std::min(bounds.min.y, p.y), std::min(bounds.min.z, p.z)};
        bounds.max = {std::max(bounds.max.x, p.x), std::max(bounds.max.y, p.y), std::max(bounds.max.z, p.z)};
    }
    /// Adds an ellipsoid or ellipse exactly: the points center + a cos + b sin (+ c ...) with half-axes a, b, c.
    void ellipsoid(Vec3d center, Vec3d a, Vec3d b, Vec3d c)
    {
        const auto reach = [](double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); };
        const Vec3d extent{reach(a.x, b.x, c.x), reach(a.y, b.y, c.y), reach(a.z, b.z, c.z)};
        point(center - extent);
        point(center + extent);
    }
};

/// Accumulates the support function: the largest dot product with each direction.
struct SupportSink {
    std::span<const Vec3d> directions;
    std::vector<double> reach;

    void point(Vec3d p)
    {
        if (std::isfinite(p.x + p.y + p.z)) add(p, [](const Vec3d&) { return 0.0; });
    }
    void ellipsoid(Vec3d center, Vec3d a, Vec3d b, Vec3d c)
    {
        if (!std::isfinite(center.x + center.y + center.z)) return;
        add(center, [&](const Vec3d& n) { return length({dot(a, n), dot(b, n), dot(c, n)}); });
    }

private:
    template <class Radius>
    void add(Vec3d p, Radius radius)
    {
        reach.resize(directions.size(), -std::numeric_limits<double>::infinity());
        for (std::size_t i = 0; i < directions.size(); ++i)
            reach[i] = std::max(reach[i], dot(p, directions[i]) + radius(directions[i]));
    }
};

template <class Sink>
void add_sphere(Sink& sink, const Transform& t, Vec3d center, double r)
{
    sink.ellipsoid(t.point(center), t.vector({r, 0, 0}), t.vector({0, r, 0}), t.vector({0, 0, r}));
}

template <class Sink>
void add_disk(Sink& sink, const Transform& t, const Disk& disk)
{
    const Vec3d n = normalize(disk.normal);
    const Vec3d u = normalize(cross(n, std::abs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0})), v = cross(n, u);
    sink.ellipsoid(t.point(disk.center), t.vector(u * disk.radius), t.vector(v * disk.radius), {});
}

template <class Sink>
void add_box(Sink& sink, const Transform& t, Vec3d min, Vec3d max)
{
    for (int i = 0; i < 8; ++i)
        sink.point(t.point({i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z}));
}

Bounds grown(const Bounds& box, double by)
{
    if (box.empty) return box;
    return {box.min - Vec3d{by, by, by}, box.max + Vec3d{by, by, by}, false};
}

/// Adds a mesh's vertices in one pose, displaced along vertex normals, or along face normals if it has none.
template <class Sink>
void add_displaced(Sink& sink, const Transform& t, const Mesh& mesh, const std::vector<Vec3f>& positions,
                   const std::vector<Vec3f>& normals, const HeightRange& heights)
{
    const auto at = [&](std::size_t i) { return Vec3d{positions[i].x, positions[i].y, positions[i].z}; };
    const auto add = [&](std::size_t i, Vec3d n) {
        sink.point(t.point(at(i) + n * heights.least));
        sink.point(t.point(at(i) + n * heights.most));
    };
    if (normals.size() == positions.size()) {
        for (std::size_t i = 0; i < positions.size(); ++i)
            add(i, normalize(Vec3d{normals[i].x, normals[i].y, normals[i].z}));
        return;
    }
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
        if (std::max({a, b, c}) >= positions.size()) continue;
        const Vec3d n = normalize(cross(at(b) - at(a), at(c) - at(a)));
        for (const std::uint32_t v : {a, b, c}) add(v, n);
    }
}

/// Bounding box of spheres. After a transform it is only approximate, but nearly exact for many small spheres.
Bounds bounds_of_spheres(const std::vector<Vec3f>& centers, const std::vector<float>& radii)
{
    BoxSink box;
    for (std::size_t i = 0; i < centers.size(); ++i) {
        const Vec3d p{centers[i].x, centers[i].y, centers[i].z}, r{radii[i], radii[i], radii[i]};
        box.point(p - r);
        box.point(p + r);
    }
    return box.bounds;
}

Bounds box_of_curves(const Curves& curves)
{
    if (curves.motion.empty()) return bounds_of_spheres(curves.points, curves.radii);
    BoxSink box;
    for (const CurvesKey& key : curves.motion) {
        const Bounds at = bounds_of_spheres(key.points, key.radii);
        if (at.empty) continue;
        box.point(at.min);
        box.point(at.max);
    }
    return box.bounds;
}

Bounds box_of_mesh(const Mesh& mesh)
{
    BoxSink box;
    const auto add = [&](const std::vector<Vec3f>& positions) {
        for (Vec3f p : positions) box.point({p.x, p.y, p.z});
    };
    for (const MeshKey& key : mesh.motion) add(key.positions);
    if (mesh.motion.empty()) add(mesh.positions);
    return box.bounds;
}

/// Bounds of meshes, curves and points, each computed on first use.
class Contents {
public:
    explicit Contents(const SceneDescription& scene) : scene_(scene) {}

    template <class Sink>
    void add_mesh(Sink& sink, const Transform& t, int index, const HeightRange& heights)
    {
        if (index < 0 || index >= int(scene_.meshes.size())) return;
        const Mesh& mesh = scene_.meshes[std::size_t(index)];
        const std::size_t points = mesh.positions.size() * std::max<std::size_t>(mesh.motion.size(), 1);
        if (points > budget_)
            return add_corners(sink, t,
                               grown(box(meshes_, scene_.meshes.size(), index, [&] { return box_of_mesh(mesh); }),
                                     std::max(std::abs(heights.least), std::abs(heights.most))));
        // Bounds are exact until the vertex budget is used up; later instances use the corners of their mesh's box.
        budget_ -= points;
        const auto add = [&](const std::vector<Vec3f>& positions, const std::vector<Vec3f>& normals) {
            if (heights.moves()) return add_displaced(sink, t, mesh, positions, normals, heights);
            for (Vec3f p : positions) sink.point(t.point({p.x, p.y, p.z}));
        };
        for (const MeshKey& key : mesh.motion) add(key.positions, key.normals);
        if (mesh.motion.empty()) add(mesh.positions, mesh.normals);
    }
    /// Range of displacement by the shape's material, for height textures with values in [0, 1].
    HeightRange displacement_range(const Shape& shape) const
    {
        const bool has_material = shape.material >= 0 && shape.material < int(scene_.materials.size());
        if (!has_material || !can_be_displaced(shape)) return {};
        return HeightRange(scene_.materials[std::size_t(shape.material)]);
    }
    template <class Sink>
    void add_curves(Sink& sink, const Transform& t, int index)
    {
        const Curves& c = scene_.curves[std::size_t(index)];
        add_corners(sink, t, box(curves_, scene_.curves.size(), index, [&] { return box_of_curves(c); }));
    }
    template <class Sink>
    void add_points(Sink& sink, const Transform& t, int index)
    {
        const Points& p = scene_.points[std::size_t(index)];
        add_corners(sink, t,
                    box(points_, scene_.points.size(), index, [&] { return bounds_of_spheres(p.centers, p.radii); }));
    }

private:
    using Boxes = std::vector<std::optional<Bounds>>;

    template <class Find>
    static const Bounds& box(Boxes& boxes, std::size_t count, int index, const Find& find)
    {
        boxes.resize(count);
        std::optional<Bounds>& known = boxes[std::size_t(index)];
        if (!known) known = find();
        return *known;
    }
    template <class Sink>
    static void add_corners(Sink& sink, const Transform& t, const Bounds& box)
    {
        if (!box.empty) add_box(sink, t, box.min, box.max);
    }

    const SceneDescription& scene_;
    Boxes meshes_, curves_, points_;
    std::size_t budget_ = 20'000'000;
};

template <class Sink>
void add_shape(Sink& sink, Contents& contents, const Transform& t, const Shape& shape)
{
    const HeightRange heights = contents.displacement_range(shape);
    if (const auto* mesh = std::get_if<MeshInstance>(&shape.geometry)) {
        contents.add_mesh(sink, t, mesh->mesh, heights);
    } else if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
        const double outwards = sphere->radius < 0 ? -heights.least : heights.most;
        const double radius = std::abs(sphere->radius) + outwards;
        add_sphere(sink, t, sphere->center, radius);
        if (sphere->center_end) add_sphere(sink, t, *sphere->center_end, radius);
    } else if (const auto* rect = std::get_if<Rectangle>(&shape.geometry)) {
        const Vec3d n = heights.moves() ? normalize(cross(rect->edge_u, rect->edge_v)) : Vec3d{};
        for (const double height : {heights.least, heights.most})
            for (int i = 0; i < 4; ++i)
                sink.point(t.point(rect->corner + rect->edge_u * (i & 1) + rect->edge_v * (i >> 1) + n * height));
    } else if (const auto* box = std::get_if<Box>(&shape.geometry)) {
        const Bounds all = grown({box->min, box->max, false}, heights.most);
        add_box(sink, t, all.min, all.max);
    } else if (const auto* disk = std::get_if<Disk>(&shape.geometry)) {
        const Vec3d n = heights.moves() ? normalize(disk->normal) : Vec3d{};
        for (const double height : {heights.least, heights.most}) {
            Disk moved = *disk;
            moved.center = disk->center + n * height;
            add_disk(sink, t, moved);
        }
    } else if (const auto* curves = std::get_if<CurvesInstance>(&shape.geometry)) {
        contents.add_curves(sink, t, curves->curves);
    } else if (const auto* points = std::get_if<PointsInstance>(&shape.geometry)) {
        contents.add_points(sink, t, points->points);
    }
}

/// Traverses the nodes. Subtrees of a moving node are added once for each of a few times.
template <class Sink>
class Walk {
public:
    Walk(const SceneDescription& scene, Sink sink) : scene_(scene), contents_(scene), sink_(std::move(sink))
    {
        for (const Node& node : scene.nodes)
            for (const NodeKey& key : node.motion) times_.push_back(key.time);
        std::sort(times_.begin(), times_.end());
        times_.erase(std::unique(times_.begin(), times_.end()), times_.end());
        // More than max_times key times are thinned out evenly; the first and the last are kept.
        if (const std::size_t all = times_.size(); all > max_times) {
            for (std::size_t i = 0; i < max_times; ++i) times_[i] = times_[i * (all - 1) / (max_times - 1)];
            times_.resize(max_times);
        }
    }

    Sink run()
    {
        for (int root : scene_.roots) add_node({}, root, nullptr, 0);
        return sink_;
    }

private:
    static constexpr std::size_t max_times = 9;

    /// time  time of the pose; null if no ancestor moves
    void add_node(const Transform& parent, int index, const double* time, int depth)
    {
        if (index < 0 || index >= int(scene_.nodes.size()) || depth > 256) return;
        const Node& node = scene_.nodes[std::size_t(index)];
        const auto add_at = [&](const Transform& t, const double* at) {
            for (const Shape& shape : node.shapes) add_shape(sink_, contents_, t, shape);
            for (int child : node.children) add_node(t, child, at, depth + 1);
        };
        if (node.motion.empty()) return add_at(parent * node.parent_from_node, time);
        if (time) return add_at(parent * transform_at(node, *time), time);
        // Between the sampled times a node may move slightly outside the bounds, which their users tolerate.
        for (const double& at : times_) add_at(parent * transform_at(node, at), &at);
    }

    const SceneDescription& scene_;
    Contents contents_;
    std::vector<double> times_;
    Sink sink_;
};

}  // namespace

Bounds shape_bounds(const SceneDescription& scene, const Shape& shape)
{
    BoxSink sink;
    Contents contents(scene);
    add_shape(sink, contents, {}, shape);
    return sink.bounds;
}

Bounds world_bounds(const SceneDescription& scene)
{
    return Walk(scene, BoxSink()).run().bounds;
}

std::vector<double> world_support(const SceneDescription& scene, std::span<const Vec3d> directions)
{
    return Walk(scene, SupportSink{directions, {}}).run().reach;
}

}  // namespace fathom
