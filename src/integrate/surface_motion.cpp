// SPDX-License-Identifier: Apache-2.0
/// This file is compiled for one lane (FATHOM_ONE_LANE): optical flow asks for each point once, and each kernel gives
/// bitwise equal results.
#include "geometry/motion.h"
#include "kernel/kernel.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

static_assert(lanes == 1);

/// A point of a triangle at a time, in the space of its vertices.
Vec3 point_of_triangle(const SceneTables& t, const SurfacePoint& point, float time)
{
    const std::uint32_t shape =
        point.instance == no_index ? t.shape_of_primitive[point.primitive] : t.instances[point.instance].shape;
    const std::uint32_t vertices = t.shapes[shape].moving_vertices;
    const KeyTime key = vertices > 0 ? vertex_key(t, time) : KeyTime{0, 0};
    const auto corner = [&](std::size_t k) {
        const std::uint32_t vertex = t.triangles[3 * std::size_t(point.primitive) + k] + key.key * vertices;
        const Vec3 now(t.positions[vertex]);
        return vertices > 0 ? mix(now, Vec3(t.positions[vertex + vertices]), key.fraction) : now;
    };
    return fma(corner(0), 1 - point.u - point.v, fma(corner(1), point.u, corner(2) * point.v));
}

}  // namespace

}  // namespace FATHOM_LANES

void move_surface_points(const SceneTables& tables, float time, const SurfacePoint* points, std::size_t count,
                         Vec3f* positions)
{
    for (std::size_t i = 0; i < count; ++i) {
        const SurfacePoint& point = points[i];
        if (point.primitive == no_index) continue;
        Vec3 p(point.place);
        if (point.primitive < tables.first_quad()) p = point_of_triangle(tables, point, time);
        if (point.instance != no_index) p = object_from_render(tables, point.instance, time, true).inverse().point(p);
        positions[i] = {p.x, p.y, p.z};
    }
}

}  // namespace fathom
