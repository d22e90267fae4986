// SPDX-License-Identifier: Apache-2.0
#include "ray_sets.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace fathom::bench {

double now(int threads)
{
    timespec t{};
    clock_gettime(threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
    return double(t.tv_sec) + double(t.tv_nsec) * 1e-9;
}

namespace {

Vec3d wide(Vec3f a)
{
    return {a.x, a.y, a.z};
}

RayView ray_view(const View& view)
{
    RayView result;
    result.position = view.position;
    result.forward = normalize(view.look_at - view.position);
    result.right = normalize(cross(result.forward, view.up));
    result.world_up = normalize(view.up);
    result.up = cross(result.right, result.forward);
    result.half_width = std::tan(view.x_fov_deg * M_PI / 360);
    result.half_height = result.half_width * result.height / result.width;
    return result;
}

/// Normal of an instanced mesh in world space.
Vec3d from_object(const InstanceRecord& instance, const Vec3d& n)
{
    const auto& m = instance.object_from_render;
    const auto column = [&](std::size_t i) { return n.x * m[i] + n.y * m[4 + i] + n.z * m[8 + i]; };
    return {column(0), column(1), column(2)};
}

std::vector<RayPoint> hit_points(const GeometryTables& tables, const Bvh& bvh, const RaySet& set)
{
    const std::size_t n = set.count();
    std::vector<float> t(n), u(n), v(n);
    std::vector<std::uint32_t> primitive(n), instance(n);
    bvh.closest(set.arrays(0, n), {t.data(), u.data(), v.data(), primitive.data(), instance.data()}, set.coherent);
    std::vector<RayPoint> points;
    for (std::size_t i = 0; i < n; ++i) {
        if (primitive[i] == no_index) continue;
        const std::uint32_t* corners = &tables.triangles[3 * std::size_t(primitive[i])];
        const Vec3d a = wide(tables.positions[corners[0]]), b = wide(tables.positions[corners[1]]),
                    c = wide(tables.positions[corners[2]]);
        const Vec3d o{set.o[0][i], set.o[1][i], set.o[2][i]}, d{set.d[0][i], set.d[1][i], set.d[2][i]};
        Vec3d normal = cross(b - a, c - a);
        if (instance[i] != no_index) normal = from_object(tables.instances[instance[i]], normal);
        normal = normalize(normal);
        points.push_back({o + d * double(t[i]), dot(normal, d) > 0 ? -normal : normal});
    }
    return points;
}

}  // namespace

std::vector<RaySet> make_ray_sets(const Mesh& mesh, const Bvh& bvh, std::size_t parts)
{
    const auto points = [&](const RaySet& set) { return hit_points(mesh.tables, bvh, set); };
    return fathom::make_ray_sets(ray_view(mesh.view), bvh.statistics().diagonal, points, parts);
}

}  // namespace fathom::bench
