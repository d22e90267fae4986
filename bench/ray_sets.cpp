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

double diagonal_of(const SceneTables& tables)
{
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (const Vec3f& p : tables.positions) {
        low = {std::min(low.x, double(p.x)), std::min(low.y, double(p.y)), std::min(low.z, double(p.z))};
        high = {std::max(high.x, double(p.x)), std::max(high.y, double(p.y)), std::max(high.z, double(p.z))};
    }
    return length(high - low);
}

std::vector<RayPoint> hit_points(const SceneTables& tables, const Bvh& bvh, const RaySet& set)
{
    const std::size_t n = set.count();
    std::vector<float> t(n), u(n), v(n);
    std::vector<std::uint32_t> primitive(n), instance(n);
    bvh.closest(set.arrays(0, n), {t.data(), u.data(), v.data(), primitive.data(), instance.data()}, set.coherent);
    std::vector<RayPoint> points;
    for (std::size_t i = 0; i < n; ++i) {
        if (primitive[i] == 0xffffffffu) continue;
        const std::uint32_t* corners = &tables.triangles[3 * std::size_t(primitive[i])];
        const Vec3d a = wide(tables.positions[corners[0]]), b = wide(tables.positions[corners[1]]),
                    c = wide(tables.positions[corners[2]]);
        const Vec3d o{set.o[0][i], set.o[1][i], set.o[2][i]}, d{set.d[0][i], set.d[1][i], set.d[2][i]};
        const Vec3d normal = normalize(cross(b - a, c - a));
        points.push_back({o + d * double(t[i]), dot(normal, d) > 0 ? -normal : normal});
    }
    return points;
}

}  // namespace

std::vector<RaySet> make_ray_sets(const Mesh& mesh, const Bvh& bvh, std::size_t parts)
{
    const auto points = [&](const RaySet& set) { return hit_points(mesh.tables, bvh, set); };
    return fathom::make_ray_sets(ray_view(mesh.view), diagonal_of(mesh.tables), points, parts);
}

}  // namespace fathom::bench
