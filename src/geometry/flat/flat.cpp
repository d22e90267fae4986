// SPDX-License-Identifier: Apache-2.0
#include "geometry/flat/oriented_boxes.h"

#include <algorithm>
#include <cmath>

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

Vec3f add(Vec3f a, Vec3f b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec3f sub(Vec3f a, Vec3f b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
float component(Vec3f a, int axis)
{
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

struct Extent {
    float lo[3], hi[3];
};

Extent extent_of(const QuadRecord& quad)
{
    const Vec3f corners[4] = {quad.corner, add(quad.corner, quad.edge_u), add(quad.corner, quad.edge_v),
                              add(add(quad.corner, quad.edge_u), quad.edge_v)};
    Extent e;
    for (int axis = 0; axis < 3; ++axis) {
        e.lo[axis] = e.hi[axis] = component(corners[0], axis);
        for (const Vec3f& c : corners) {
            e.lo[axis] = std::min(e.lo[axis], component(c, axis));
            e.hi[axis] = std::max(e.hi[axis], component(c, axis));
        }
    }
    return e;
}

/// The axis that an axis-aligned rectangle is perpendicular to, or -1 for other quads.
int flat_axis(const QuadRecord& quad, float tolerance)
{
    const auto along_one_axis = [&](Vec3f e) {
        int axes = 0;
        for (int axis = 0; axis < 3; ++axis) axes += std::fabs(component(e, axis)) > tolerance;
        return axes == 1;
    };
    if (!along_one_axis(quad.edge_u) || !along_one_axis(quad.edge_v)) return -1;
    const Extent e = extent_of(quad);
    for (int axis = 0; axis < 3; ++axis)
        if (e.hi[axis] - e.lo[axis] <= tolerance) return axis;
    return -1;
}

bool close(float a, float b, float tolerance)
{
    return std::fabs(a - b) <= tolerance;
}

/// Code, 2 axis + high, of the box face that the rectangle covers exactly, or -1.
int face_of(const Extent& box, const Extent& rectangle, int axis, float tolerance)
{
    for (int other = 0; other < 3; ++other)
        if (other != axis && (!close(box.lo[other], rectangle.lo[other], tolerance) ||
                              !close(box.hi[other], rectangle.hi[other], tolerance)))
            return -1;
    if (close(box.lo[axis], rectangle.lo[axis], tolerance)) return 2 * axis;
    if (close(box.hi[axis], rectangle.lo[axis], tolerance)) return 2 * axis + 1;
    return -1;
}

struct BoxFinder {
    const GeometryTables& tables;
    float tolerance;
    std::vector<Extent> extents;
    std::vector<int> axes;
    std::vector<bool> used;

    BoxFinder(const GeometryTables& t, float tol) : tables(t), tolerance(tol), used(t.quads.size())
    {
        for (const QuadRecord& quad : t.quads) {
            extents.push_back(extent_of(quad));
            axes.push_back(flat_axis(quad, tol));
        }
    }

    /// The bounding box of two rectangles, with every unused rectangle that covers a face of the box.
    FlatScene::Box around(std::size_t i, std::size_t j, int& faces) const
    {
        Extent e = extents[i];
        for (int axis = 0; axis < 3; ++axis) {
            e.lo[axis] = std::min(e.lo[axis], extents[j].lo[axis]);
            e.hi[axis] = std::max(e.hi[axis], extents[j].hi[axis]);
        }
        FlatScene::Box box{{e.lo[0], e.lo[1], e.lo[2]}, {e.hi[0], e.hi[1], e.hi[2]}, false, {}};
        std::fill(std::begin(box.faces), std::end(box.faces), no_index);
        faces = 0;
        for (std::size_t k = 0; k < extents.size(); ++k) {
            if (used[k] || axes[k] < 0) continue;
            const int face = face_of(e, extents[k], axes[k], tolerance);
            if (face < 0 || box.faces[face] != no_index) continue;
            box.faces[face] = tables.first_quad() + std::uint32_t(k);
            ++faces;
        }
        box.closed = faces == 6;
        return box;
    }

    std::vector<FlatScene::Box> find()
    {
        std::vector<FlatScene::Box> boxes;
        for (int wanted = 6; wanted >= 3; --wanted)
            for (std::size_t i = 0; i < extents.size(); ++i)
                for (std::size_t j = i + 1; j < extents.size(); ++j) {
                    if (used[i] || used[j] || axes[i] < 0 || axes[j] < 0 || axes[i] == axes[j]) continue;
                    int faces = 0;
                    const FlatScene::Box box = around(i, j, faces);
                    if (faces != wanted || !contains(box, i) || !contains(box, j)) continue;
                    for (std::uint32_t face : box.faces)
                        if (face != no_index) used[face - tables.first_quad()] = true;
                    boxes.push_back(box);
                }
        for (std::size_t i = 0; i < extents.size(); ++i)
            if (!used[i] && axes[i] >= 0) boxes.push_back(plate(i));
        return boxes;
    }

    FlatScene::Box plate(std::size_t i)
    {
        const Extent& e = extents[i];
        FlatScene::Box box{{e.lo[0], e.lo[1], e.lo[2]}, {e.hi[0], e.hi[1], e.hi[2]}, false, {}};
        std::fill(std::begin(box.faces), std::end(box.faces), no_index);
        box.faces[2 * axes[i]] = box.faces[2 * axes[i] + 1] = tables.first_quad() + std::uint32_t(i);
        used[i] = true;
        return box;
    }

    bool contains(const FlatScene::Box& box, std::size_t quad) const
    {
        return std::find(box.faces, box.faces + 6, tables.first_quad() + std::uint32_t(quad)) != box.faces + 6;
    }
};

/// Points whose convex hull contains the scene and its lights.
std::vector<Vec3d> hull_points(const GeometryTables& tables, const ShadowTargets& targets)
{
    std::vector<Vec3d> points;
    for (const QuadRecord& q : tables.quads)
        for (int i = 0; i < 4; ++i)
            points.push_back(to_double(q.corner) + to_double(q.edge_u) * (i & 1) + to_double(q.edge_v) * (i >> 1));
    for (std::uint32_t v : tables.triangles) points.push_back(to_double(tables.positions[v]));
    const auto add_round = [&](Vec3f center, double radius) {
        for (int i = 0; i < 8; ++i)
            points.push_back(to_double(center) +
                             Vec3d{i & 1 ? radius : -radius, i & 2 ? radius : -radius, i & 4 ? radius : -radius});
    };
    for (const SphereRecord& s : tables.spheres) {
        add_round(s.center, std::fabs(s.radius));
        add_round(add(s.center, s.motion), std::fabs(s.radius));
    }
    for (const DiskRecord& d : tables.disks) add_round(d.center, d.radius);
    for (Vec3f place : targets.places) points.push_back(to_double(place));
    return points;
}

/// Whether all points lie on one side of the plane: then it cannot lie between two of them.
bool on_hull(const std::vector<Vec3d>& points, Vec3d on_plane, Vec3d normal, double tolerance)
{
    double lo = 0, hi = 0;
    for (const Vec3d& p : points) {
        const double side = dot(p - on_plane, normal);
        lo = std::min(lo, side);
        hi = std::max(hi, side);
    }
    return lo >= -tolerance || hi <= tolerance;
}

}  // namespace

bool FlatScene::fits(const GeometryTables& tables)
{
    return !tables.editable && tables.instances.empty() && tables.vertex_times.empty() && tables.curves.empty() &&
           tables.points.empty() && tables.primitive_count() <= max_primitives &&
           tables.triangle_count() <= max_triangles;
}

void FlatScene::build(const GeometryTables& tables, const ShadowTargets& targets)
{
    const std::vector<Vec3d> points = hull_points(tables, targets);
    double radius = 0;
    for (const Vec3d& p : points) radius = std::max({radius, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    const double tolerance = radius * 1e-6;

    BoxFinder finder(tables, float(tolerance));
    all = {};
    all.boxes = finder.find();
    all.oriented_boxes = find_oriented_boxes(tables, finder.used, tolerance);
    face_primitives.clear();
    const auto add_faces = [&](const Box& box) {
        face_primitives.insert(face_primitives.end(), box.faces, box.faces + codes_per_box);
    };
    for (const Box& box : all.boxes) add_faces(box);
    for (const OrientedBox& box : all.oriented_boxes) add_faces(box.unit);
    face_primitives.resize(face_primitives.size() + lookup_size, no_index);
    for (std::uint32_t i = 0; i < tables.quads.size(); ++i) {
        if (finder.used[i]) continue;
        const QuadRecord& q = tables.quads[i];
        const Vec3d u = to_double(q.edge_u), v = to_double(q.edge_v), n = cross(u, v);
        const double n2 = dot(n, n);
        if (n2 == 0) continue;
        all.quads.push_back({q.corner, to_float(normalize(n)), to_float(cross(v, n) * (1 / n2)),
                             to_float(cross(n, u) * (1 / n2)), tables.first_quad() + i});
    }
    for (std::uint32_t i = 0; i < tables.triangle_count(); ++i) {
        const std::uint32_t* v = &tables.triangles[3 * i];
        all.triangles.push_back({tables.positions[v[0]], tables.positions[v[1]], tables.positions[v[2]], i});
    }
    for (std::uint32_t i = 0; i < tables.spheres.size(); ++i) all.spheres.push_back({i, tables.first_sphere() + i});
    for (std::uint32_t i = 0; i < tables.disks.size(); ++i) all.disks.push_back({i, tables.first_disk() + i});

    find_occluders(tables, targets, points, tolerance);
    for (List* list : {&all, &occluders})
        list->only_boxes = list->oriented_boxes.empty() && list->quads.empty() && list->triangles.empty() &&
                           list->spheres.empty() && list->disks.empty();
}

void FlatScene::find_occluders(const GeometryTables& tables, const ShadowTargets& targets,
                               const std::vector<Vec3d>& points, double tolerance)
{
    occluders = all;
    if (targets.infinite) return;
    const auto quad_on_hull = [&](std::uint32_t primitive) {
        const QuadRecord& q = tables.quads[primitive - tables.first_quad()];
        return on_hull(points, to_double(q.corner), normalize(cross(to_double(q.edge_u), to_double(q.edge_v))),
                       tolerance);
    };
    // A ray to a point on the only light, which is flat, is not blocked by that light.
    const std::uint32_t only_light = targets.only_primitive;
    const auto stops_nothing = [&](const Box& box) {
        return std::all_of(box.faces, box.faces + 6, [&](std::uint32_t face) {
            return face == no_index || face == only_light || quad_on_hull(face);
        });
    };
    std::erase_if(occluders.boxes, stops_nothing);
    std::erase_if(occluders.oriented_boxes, [&](const OrientedBox& box) { return stops_nothing(box.unit); });
    std::erase_if(occluders.quads,
                  [&](const Quad& q) { return q.primitive == only_light || quad_on_hull(q.primitive); });
    std::erase_if(occluders.triangles, [&](const Triangle& t) {
        const Vec3d n = cross(to_double(sub(t.b, t.a)), to_double(sub(t.c, t.a)));
        return t.primitive == only_light || on_hull(points, to_double(t.a), normalize(n), tolerance);
    });
}

}  // namespace FATHOM_LANES
}  // namespace fathom
