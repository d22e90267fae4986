// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Ray intersections in double precision from the definitions of the shapes, independent of src/geometry.
#include <algorithm>
#include <cmath>
#include <limits>

#include "fathom/vector.h"

namespace fathom::plain {

inline constexpr double nothing = std::numeric_limits<double>::infinity();

inline Vec3d wide(Vec3f v)
{
    return {v.x, v.y, v.z};
}

struct Crossing {
    double t = nothing;
    double u = 0, v = 0;  ///< coordinates along the two edges, from 0 to 1 inside
};

/// Intersection with the plane through a corner and two edges, in coordinates along the edges.
inline Crossing cross_plane(Vec3d corner, Vec3d eu, Vec3d ev, Vec3d o, Vec3d d)
{
    const Vec3d n = cross(eu, ev), r = o - corner;
    const double slope = dot(n, d);
    if (slope == 0) return {};
    Crossing c;
    c.t = -dot(n, r) / slope;
    const Vec3d p = r + d * c.t;
    c.u = dot(cross(p, ev), n) / dot(n, n);
    c.v = dot(cross(eu, p), n) / dot(n, n);
    return c;
}

/// grow: fraction of the edges by which a shape is enlarged, or shrunk if negative.
inline Crossing intersect_triangle(Vec3d a, Vec3d b, Vec3d c, Vec3d o, Vec3d d, double grow = 0)
{
    const Crossing x = cross_plane(a, b - a, c - a, o, d);
    return x.t > 0 && std::min({x.u, x.v, 1 - x.u - x.v}) >= -grow ? x : Crossing{};
}
inline Crossing intersect_parallelogram(Vec3d corner, Vec3d eu, Vec3d ev, Vec3d o, Vec3d d, double grow = 0)
{
    const Crossing x = cross_plane(corner, eu, ev, o, d);
    return x.t > 0 && std::min({x.u, x.v, 1 - x.u, 1 - x.v}) >= -grow ? x : Crossing{};
}
inline double intersect_sphere(Vec3d center, double radius, Vec3d o, Vec3d d, double grow = 0)
{
    const Vec3d r = o - center;
    const double b = dot(r, d), c = dot(r, r) - radius * radius * (1 + grow) * (1 + grow), h = b * b - c;
    if (h < 0) return nothing;
    const double near = -b - std::sqrt(h), far = -b + std::sqrt(h);
    return near > 0 ? near : far > 0 ? far : nothing;
}
inline double intersect_disk(Vec3d center, Vec3d n, double radius, Vec3d o, Vec3d d, double grow = 0)
{
    const double slope = dot(n, d);
    if (slope == 0) return nothing;
    const double t = dot(n, center - o) / slope;
    return t > 0 && length(o + d * t - center) <= radius * (1 + grow) ? t : nothing;
}

}  // namespace fathom::plain
