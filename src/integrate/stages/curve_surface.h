#pragma once
/// The surface of a curve where a ray has met one of its pieces.
#include "geometry/shapes/curve.h"
#include "integrate/stages/surface_hit.h"
#include "math/gather_member.h"

namespace fathom::inline FATHOM_LANES {

/// segment  of each lane of the mask, in tables.curves
/// u        along it, as traversal found it
/// d        unit direction of the ray, in the space of the curve
/// surface  p is the hit point; set are place, normals, tangent, uv (u along the whole curve, v across) and offset
inline void read_curve(const SceneTables& tables, UInt segment, UInt flags, Float u, const Vec3& d, Mask m,
                       Surface& surface)
{
    const UInt first = gather(tables.curves, &CurveRecord::first_point, segment, m);
    const Float pieces = to_float(gather(tables.curves, &CurveRecord::pieces, segment, m));
    const Float u0 = gather(tables.curves, &CurveRecord::u0, segment, m),
                u1 = gather(tables.curves, &CurveRecord::u1, segment, m);
    const Mask linear = (flags & UInt(ShapeRecord::linear_curves)) != UInt(0u);
    const Mask ribbon = (flags & UInt(ShapeRecord::ribbons)) != UInt(0u);

    const float* points = reinterpret_cast<const float*>(tables.curve_points.data());
    CurvePoint<Float> p[4];
    for (std::uint32_t k = 0; k < 4; ++k) {
        const Mask has = k < 2 ? m : m & !linear;
        const UInt place = (first + UInt(k)) << 2;
        p[k] = {gather(points, place, has), gather(points + 1, place, has), gather(points + 2, place, has),
                gather(points + 3, place, has)};
    }
    // The piece, to the bits that the tree has of it, and the ball that touches it in the hit.
    const Float piece = min(floor(u * pieces), pieces - Float(1)), share = Float(1) / pieces;
    const auto end = [&](Float k) {
        const CurvePoint<Float> c = bezier(p, k * share), l = between(p[0], p[1], k);
        return CurvePoint<Float>{select(linear, l.x, c.x), select(linear, l.y, c.y), select(linear, l.z, c.z),
                                 select(linear, l.r, c.r)};
    };
    const CurvePoint<Float> a = end(piece), b = end(piece + Float(1));
    const CurvePoint<Float> c = between(a, b, clamp(fma(u, pieces, -piece), Float(0), Float(1)));
    const Vec3 center{c.x, c.y, c.z}, axis{b.x - a.x, b.y - a.y, b.z - a.z};
    const Vec3 from_axis = surface.p - center;
    const Float length2 = dot(from_axis, from_axis);
    const Vec3 round = select(length2 > Float(0), from_axis * inverse_sqrt(max(length2, Float(1e-37f))), -d);

    // A ribbon is perpendicular to the ray but for its slope along the axis.
    const Float axis2 = max(dot(axis, axis), Float(1e-37f));
    const Vec3 facing = fma(axis, dot(d, axis) / axis2, -d);
    const Vec3 flat =
        select(dot(facing, facing) > Float(1e-6f), facing * inverse_sqrt(max(dot(facing, facing), Float(1e-37f))), -d);
    const Vec3 n = select(ribbon, flat, round);
    surface.ng = select(m, n, surface.ng);
    surface.ns = select(m, n, surface.ns);
    surface.p = select(m & !ribbon, fma(round, c.r, center), surface.p);
    surface.tangent = select(m, axis, surface.tangent);
    // A ray that leaves a ribbon would meet it again, turned towards that ray, if it did not begin farther away than
    // half the width. Of round curves the test with its many steps decides.
    const Float rounding = Float(0x1p-19f) * max(max_abs(surface.p), c.r);
    surface.offset = select(m, max(rounding, select(ribbon, c.r * Float(1.0625f), Float(0))), surface.offset);
    const Vec3 side = cross(axis, d);
    const Float across =
        dot(from_axis, side) * inverse_sqrt(max(dot(side, side), Float(1e-37f))) / max(c.r, Float(1e-30f));
    for (int i = 0; i < 2; ++i) {
        surface.at.u[i] = select(m, fma(u1 - u0, u, u0), surface.at.u[i]);
        surface.at.v[i] = select(m, clamp(fma(across, Float(0.5f), Float(0.5f)), Float(0), Float(1)), surface.at.v[i]);
    }
}

}  // namespace fathom::inline FATHOM_LANES
