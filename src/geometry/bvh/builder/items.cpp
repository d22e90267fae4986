// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/items.h"
#include "geometry/bvh/builder/leaf_data.h"
#include "geometry/bvh/builder/motion.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

Vec3f add(Vec3f a, Vec3f b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
bool equal(Vec3f a, Vec3f b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}
bool finite(Vec3f a)
{
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace

void vertices_of(const GeometryTables& tables, BvhKey key, Vec3f out[3], std::size_t time)
{
    const std::uint32_t primitive = key >> 1;
    if (primitive < tables.first_quad()) {
        const std::size_t offset =
            time == 0 ? 0 : time * tables.shapes[tables.shape_of_primitive[primitive]].moving_vertices;
        for (std::size_t i = 0; i < 3; ++i)
            out[i] = tables.positions[tables.triangles[3 * std::size_t(primitive) + i] + offset];
        return;
    }
    const QuadRecord& q = tables.quads[primitive - tables.first_quad()];
    const Vec3f u = add(q.corner, q.edge_u), v = add(q.corner, q.edge_v);
    out[0] = key & 1 ? add(u, q.edge_v) : q.corner;
    out[1] = key & 1 ? v : u;
    out[2] = key & 1 ? u : v;
}

namespace bvh {

namespace {

void set_box(Item& item, const Vec3d& low, const Vec3d& high)
{
    // The box is rounded outward so that it contains the exact one.
    constexpr float inf = std::numeric_limits<float>::infinity();
    const double lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
    for (int axis = 0; axis < 3; ++axis) {
        item.low[axis] = std::nextafter(float(lows[axis]), -inf);
        item.minus_high[axis] = -std::nextafter(float(highs[axis]), inf);
    }
}

bool moves(const GeometryTables& tables, std::uint32_t primitive)
{
    return !tables.vertex_times.empty() && primitive < tables.first_quad() &&
           tables.shapes[tables.shape_of_primitive[primitive]].moving_vertices > 0;
}

bool moving_triangle_item(const GeometryTables& tables, const BvhData& bvh, BvhKey key, Item& item)
{
    for (std::size_t k = 0; k < tables.vertex_times.size(); ++k) {
        Vec3f v[3];
        vertices_of(tables, key, v, k);
        if (!finite(v[0]) || !finite(v[1]) || !finite(v[2])) return false;
    }
    set_box(item, moving_box(tables, bvh, {}, Item::moving_triangle, key).middle());
    item.id = key;
    item.kind = Item::moving_triangle;
    return true;
}

/// Sets up an item for a triangle; false if no ray can hit it.
bool triangle_item(const GeometryTables& tables, const BvhData& bvh, BvhKey key, Item& item)
{
    if (moves(tables, key >> 1)) return moving_triangle_item(tables, bvh, key, item);
    Vec3f v[3];
    vertices_of(tables, key, v);
    if (!finite(v[0]) || !finite(v[1]) || !finite(v[2])) return false;
    if (equal(v[0], v[1]) || equal(v[1], v[2]) || equal(v[2], v[0])) return false;
    item.low[0] = std::min({v[0].x, v[1].x, v[2].x});
    item.low[1] = std::min({v[0].y, v[1].y, v[2].y});
    item.low[2] = std::min({v[0].z, v[1].z, v[2].z});
    item.minus_high[0] = -std::max({v[0].x, v[1].x, v[2].x});
    item.minus_high[1] = -std::max({v[0].y, v[1].y, v[2].y});
    item.minus_high[2] = -std::max({v[0].z, v[1].z, v[2].z});
    item.id = key;
    item.kind = Item::triangle;
    return true;
}

bool sphere_item(const GeometryTables& tables, const BvhData& bvh, std::uint32_t index, Item& item)
{
    const SphereRecord& s = tables.spheres[index];
    if (!finite(s.center) || !finite(s.motion) || !std::isfinite(s.radius) || s.radius == 0) return false;
    set_box(item, moving_box(tables, bvh, {}, Item::sphere, index).middle());
    item.id = index;
    item.kind = Item::sphere;
    return true;
}

bool disk_item(const GeometryTables& tables, std::uint32_t index, Item& item)
{
    const DiskRecord& d = tables.disks[index];
    if (!finite(d.center) || !finite(d.normal) || !(d.radius > 0) || !std::isfinite(d.radius)) return false;
    const double n[3] = {d.normal.x, d.normal.y, d.normal.z}, center[3] = {d.center.x, d.center.y, d.center.z};
    const double n2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
    if (!(n2 > 0)) return false;
    double low[3], high[3];
    for (int i = 0; i < 3; ++i) {
        const double r = d.radius * (std::sqrt(std::max(0.0, 1 - n[i] * n[i] / n2)) + 0x1p-18);
        low[i] = center[i] - r;
        high[i] = center[i] + r;
    }
    set_box(item, {low[0], low[1], low[2]}, {high[0], high[1], high[2]});
    item.id = index;
    item.kind = Item::disk;
    return true;
}

bool curve_item(const GeometryTables& tables, const BvhData& bvh, std::uint32_t segment, std::uint32_t piece,
                Item& item)
{
    const ShapeRecord& shape = shape_of_segment(tables, segment);
    if (piece >= tables.curves[segment].pieces) return false;
    const std::uint32_t id = piece_id(segment, piece);
    const std::size_t times = shape.moving_vertices > 0 ? tables.vertex_times.size() : 1;
    bool has_radius = false;
    for (std::size_t key = 0; key < times; ++key) {
        const PieceEnds ends = piece_ends(tables, id, shape.flags & ShapeRecord::linear_curves, key);
        const CurvePoint<float>&a = ends.a, &b = ends.b;
        for (float x : {a.x, a.y, a.z, a.r, b.x, b.y, b.z, b.r})
            if (!std::isfinite(x)) return false;
        has_radius |= a.r > 0 || b.r > 0;
        if (times == 1) set_box(item, box_of(ends));
    }
    if (!has_radius) return false;
    if (times > 1) set_box(item, moving_box(tables, bvh, {}, Item::curve, id).middle());
    item.id = id;
    item.kind = shape.flags & ShapeRecord::ribbons ? Item::ribbon : Item::curve;
    return true;
}

bool point_item(const GeometryTables& tables, std::uint32_t index, Item& item)
{
    const Vec4f& p = tables.points[index];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z) || !std::isfinite(p.w) || !(p.w > 0))
        return false;
    const double r = p.w * (1 + 0x1p-18);
    set_box(item, {p.x - r, p.y - r, p.z - r}, {p.x + r, p.y + r, p.z + r});
    item.id = index;
    item.kind = Item::point;
    return true;
}

bool instance_item(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes,
                   std::uint32_t index, Item& item)
{
    const InstanceRecord& instance = tables.instances[index];
    for (float x : instance.object_from_render)
        if (!std::isfinite(x)) return false;
    if (bvh.meshes[instance.mesh_shape].empty) return false;
    set_box(item, moving_box(tables, bvh, mesh_boxes, Item::instance, index).middle());
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(item.low[axis]) || !std::isfinite(item.minus_high[axis])) return false;
    item.id = index;
    item.kind = Item::instance;
    return true;
}

/// Creates items [0, n) in parallel; make(i, item) returns false to omit one.
template <class Make>
ItemList make_items(std::size_t n, const Make& make)
{
    ItemList list;
    list.items = LargeArray<Item>(n);
    constexpr std::size_t chunk = 1 << 14;
    const std::size_t chunks = (n + chunk - 1) / chunk;
    struct Part {
        std::size_t count = 0, triangles = 0;
        Box box;
        CenterBounds centers;
    };
    std::vector<Part> parts(chunks);
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t c) {
        Part part;
        for (std::size_t i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) {
            Item& item = list.items[c * chunk + part.count];
            if (!make(i, item)) continue;
            ++part.count;
            part.triangles += item.kind == Item::triangle;
            part.box.extend(item);
            part.centers.extend(center2(item));
        }
        parts[c] = part;
    });
    for (std::size_t c = 0; c < chunks; ++c) {
        list.count += parts[c].count;
        list.triangles += parts[c].triangles;
        list.box.extend(parts[c].box);
        list.centers.extend(parts[c].centers);
    }
    // Items that make() omitted left gaps in the array, which the last items fill.
    std::size_t last = chunks;
    for (std::size_t c = 0; c < last; ++c)
        for (std::size_t& i = parts[c].count; c * chunk + i < std::min(list.count, (c + 1) * chunk);) {
            while (parts[last - 1].count == 0) --last;
            list.items[c * chunk + i++] = list.items[(last - 1) * chunk + --parts[last - 1].count];
        }
    return list;
}

}  // namespace

namespace {

/// Largest number of pieces among n segments. Each segment gets this many candidate items; surplus ones are omitted.
std::uint32_t max_pieces(const GeometryTables& tables, std::size_t first, std::size_t n)
{
    std::uint32_t most = 1;
    for (std::size_t i = first; i < first + n; ++i) most = std::max(most, tables.curves[i].pieces);
    return most;
}

}  // namespace

ItemList shape_items(const GeometryTables& tables, const BvhData& bvh, std::uint32_t first, std::uint32_t last)
{
    const std::size_t n = last - first;
    if (first < tables.first_quad())
        return make_items(
            n, [&](std::size_t i, Item& item) { return triangle_item(tables, bvh, BvhKey(2 * (first + i)), item); });
    if (first < tables.first_sphere())
        return make_items(2 * n, [&](std::size_t i, Item& item) {
            return triangle_item(tables, bvh, BvhKey(2 * std::size_t(first) + i), item);
        });
    if (first < tables.first_disk())
        return make_items(n, [&](std::size_t i, Item& item) {
            return sphere_item(tables, bvh, std::uint32_t(first - tables.first_sphere() + i), item);
        });
    if (first < tables.first_curve())
        return make_items(n, [&](std::size_t i, Item& item) {
            return disk_item(tables, std::uint32_t(first - tables.first_disk() + i), item);
        });
    if (first < tables.first_point()) {
        const std::uint32_t most = max_pieces(tables, first - tables.first_curve(), n);
        return make_items(n * most, [&, most](std::size_t i, Item& item) {
            return curve_item(tables, bvh, std::uint32_t(first - tables.first_curve() + i / most), i % most, item);
        });
    }
    return make_items(n, [&](std::size_t i, Item& item) {
        return point_item(tables, std::uint32_t(first - tables.first_point() + i), item);
    });
}

ItemList world_items(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes)
{
    const std::uint32_t most = max_pieces(tables, 0, tables.curves.size());
    const std::size_t triangles = tables.world_triangles, quads = triangles + 2 * tables.quads.size(),
                      spheres = quads + tables.spheres.size(), disks = spheres + tables.disks.size(),
                      curves = disks + most * tables.curves.size(), points = curves + tables.points.size();
    const auto placed = [&](std::size_t primitive) {
        return (tables.shapes[tables.shape_of_primitive[primitive]].flags & ShapeRecord::only_instanced) != 0;
    };
    const std::size_t instances = tables.editable ? tables.still_instances : tables.instances.size();
    return make_items(points + instances, [&](std::size_t i, Item& item) {
        if (i < triangles) return triangle_item(tables, bvh, BvhKey(2 * i), item);
        if (i < quads) {
            const std::size_t key = 2 * std::size_t(tables.first_quad()) + (i - triangles);
            return !placed(key / 2) && triangle_item(tables, bvh, BvhKey(key), item);
        }
        if (i < spheres)
            return !placed(tables.first_sphere() + (i - quads)) &&
                   sphere_item(tables, bvh, std::uint32_t(i - quads), item);
        if (i < disks)
            return !placed(tables.first_disk() + (i - spheres)) && disk_item(tables, std::uint32_t(i - spheres), item);
        if (i < curves) {
            const auto segment = std::uint32_t((i - disks) / most), piece = std::uint32_t((i - disks) % most);
            return !placed(tables.first_curve() + segment) && curve_item(tables, bvh, segment, piece, item);
        }
        if (i < points)
            return !placed(tables.first_point() + (i - curves)) && point_item(tables, std::uint32_t(i - curves), item);
        return instance_item(tables, bvh, mesh_boxes, std::uint32_t(i - points), item);
    });
}

ItemList movable_items(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes)
{
    const std::uint32_t first = tables.still_instances;
    return make_items(tables.instances.size() - first, [&](std::size_t i, Item& item) {
        return instance_item(tables, bvh, mesh_boxes, first + std::uint32_t(i), item);
    });
}

}  // namespace bvh

}  // namespace fathom
