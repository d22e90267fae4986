#include "geometry/bvh_items.h"

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

void vertices_of(const SceneTables& tables, BvhKey key, Vec3f out[3])
{
    const std::uint32_t primitive = key >> 1;
    if (primitive < tables.first_quad()) {
        for (std::size_t i = 0; i < 3; ++i) out[i] = tables.positions[tables.triangles[3 * std::size_t(primitive) + i]];
        return;
    }
    const QuadTable& q = tables.quads[primitive - tables.first_quad()];
    const Vec3f u = add(q.corner, q.edge_u), v = add(q.corner, q.edge_v);
    out[0] = key & 1 ? add(u, q.edge_v) : q.corner;
    out[1] = key & 1 ? v : u;
    out[2] = key & 1 ? u : v;
}

namespace bvh {

namespace {

void set_box(Item& item, const Vec3d& low, const Vec3d& high)
{
    // Rounded outwards.
    constexpr float inf = std::numeric_limits<float>::infinity();
    const double lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
    for (int axis = 0; axis < 3; ++axis) {
        item.low[axis] = std::nextafter(float(lows[axis]), -inf);
        item.minus_high[axis] = -std::nextafter(float(highs[axis]), inf);
    }
}

/// False where nothing can hit it.
bool triangle_item(const SceneTables& tables, BvhKey key, Item& item)
{
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

bool sphere_item(const SceneTables& tables, std::uint32_t index, Item& item)
{
    const SphereTable& s = tables.spheres[index];
    if (!finite(s.center) || !finite(s.motion) || !std::isfinite(s.radius) || s.radius == 0) return false;
    // A little larger: the distance found by closest_sphere has rounding errors of its own.
    const double r = std::fabs(double(s.radius)) * (1 + 0x1p-18);
    const double center[3] = {s.center.x, s.center.y, s.center.z}, motion[3] = {s.motion.x, s.motion.y, s.motion.z};
    const double open = tables.shutter_open, close = tables.shutter_close;
    double low[3], high[3];
    for (int i = 0; i < 3; ++i) {
        low[i] = center[i] + std::min(motion[i] * open, motion[i] * close) - r;
        high[i] = center[i] + std::max(motion[i] * open, motion[i] * close) + r;
    }
    set_box(item, {low[0], low[1], low[2]}, {high[0], high[1], high[2]});
    item.id = index;
    item.kind = Item::sphere;
    return true;
}

bool disk_item(const SceneTables& tables, std::uint32_t index, Item& item)
{
    const DiskTable& d = tables.disks[index];
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

double row_sum_norm(const std::array<float, 12>& m)
{
    double norm = 0;
    for (std::size_t row = 0; row < 3; ++row)
        norm = std::max(norm, double(std::fabs(m[4 * row])) + std::fabs(m[4 * row + 1]) + std::fabs(m[4 * row + 2]));
    return norm;
}

bool instance_item(const SceneTables& tables, const BvhData& bvh, const std::vector<Box>& mesh_boxes,
                   std::uint32_t index, Item& item)
{
    const InstanceTable& instance = tables.instances[index];
    const std::uint32_t mesh = bvh.mesh_of_instance[index];
    for (float x : instance.render_from_object)
        if (!std::isfinite(x)) return false;
    for (float x : instance.object_from_render)
        if (!std::isfinite(x)) return false;
    if (bvh.meshes[mesh].empty) return false;
    const auto& m = instance.render_from_object;
    double low[3], high[3], radius = 0;
    for (std::size_t row = 0; row < 3; ++row) {
        low[row] = high[row] = m[4 * row + 3];
        for (int axis = 0; axis < 3; ++axis) {
            const double a = double(m[4 * row + std::size_t(axis)]) * mesh_boxes[mesh].low(axis);
            const double b = double(m[4 * row + std::size_t(axis)]) * mesh_boxes[mesh].high(axis);
            low[row] += std::min(a, b);
            high[row] += std::max(a, b);
        }
        radius = std::max({radius, std::fabs(low[row]), std::fabs(high[row])});
    }
    // A ray is rounded when it is moved into the mesh's space; seen from here, by this much more the less alike the
    // mesh's axes are scaled.
    const double condition = row_sum_norm(instance.render_from_object) * row_sum_norm(instance.object_from_render);
    const double margin = 0x1p-20 * condition * radius;
    for (int row = 0; row < 3; ++row) {
        low[row] -= margin;
        high[row] += margin;
    }
    set_box(item, {low[0], low[1], low[2]}, {high[0], high[1], high[2]});
    item.id = index;
    item.kind = Item::instance;
    return true;
}

/// Items [0, n), each made by make(i, item) or left out.
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
        if (list.count != c * chunk)
            std::memmove(&list.items[list.count], &list.items[c * chunk], parts[c].count * sizeof(Item));
        list.count += parts[c].count;
        list.triangles += parts[c].triangles;
        list.box.extend(parts[c].box);
        list.centers.extend(parts[c].centers);
    }
    return list;
}

}  // namespace

float ItemList::radius() const
{
    float r = 0;
    for (int axis = 0; axis < 3 && count; ++axis)
        r = std::max({r, std::fabs(box.low(axis)), std::fabs(box.high(axis))});
    return r;
}

ItemList mesh_items(const SceneTables& tables, std::uint32_t first, std::uint32_t last)
{
    return make_items(last - first, [&](std::size_t i, Item& item) {
        return triangle_item(tables, 2 * (first + std::uint32_t(i)), item);
    });
}

ItemList world_items(const SceneTables& tables, const BvhData& bvh, const std::vector<Box>& mesh_boxes)
{
    const std::size_t triangles = tables.world_triangles, quads = triangles + 2 * tables.quads.size(),
                      spheres = quads + tables.spheres.size(), disks = spheres + tables.disks.size();
    return make_items(disks + tables.instances.size(), [&](std::size_t i, Item& item) {
        if (i < triangles) return triangle_item(tables, BvhKey(2 * i), item);
        if (i < quads) return triangle_item(tables, BvhKey(2 * tables.first_quad() + (i - triangles)), item);
        if (i < spheres) return sphere_item(tables, std::uint32_t(i - quads), item);
        if (i < disks) return disk_item(tables, std::uint32_t(i - spheres), item);
        return instance_item(tables, bvh, mesh_boxes, std::uint32_t(i - disks), item);
    });
}

}  // namespace bvh

}  // namespace fathom
