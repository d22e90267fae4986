// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Surface of a curve at a hit on one of its pieces.
#include "geometry/shapes/curve_reader.h"
#include "geometry/surface/surface_hit.h"
#include "kernel/tables.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Sets position, normals, tangent, texture coordinates (u along the whole curve, v across), offset and radius of
/// `surface` in the lanes of m. surface.p must be the hit point.
///
/// segment: index in tables.curves. flags: of surface.shape. hit: its u (along the segment, from traversal) and time
/// are used. d: unit direction of the ray in the curve's space.
inline void read_curve(const SceneTables& tables, UInt segment, UInt flags, const SurfaceHit& hit, const Vec3& d,
                       Mask m, Surface& surface)
{
    const Float u = hit.u;
    const CurveReader curve(tables, segment, surface.shape, flags, hit.time, m);
    const Float pieces = curve.pieces();
    const Float u0 = gather(tables.curves, &CurveRecord::u0, segment, m),
                u1 = gather(tables.curves, &CurveRecord::u1, segment, m);
    const Mask ribbon = (flags & UInt(ShapeRecord::ribbons)) != UInt(0u);

    // The piece, bitwise equal to that of the BVH, and the ball that touches its surface at the hit.
    const Float piece = curve.piece_of(u);
    const CurvePoint<Float> a = curve.begin(piece), b = curve.end(piece);
    const CurvePoint<Float> c = between(a, b, clamp(fma(u, pieces, -piece), Float(0), Float(1)));
    const Vec3 center{c.x, c.y, c.z}, axis{b.x - a.x, b.y - a.y, b.z - a.z};
    const Vec3 from_axis = surface.p - center;
    const Float length2 = dot(from_axis, from_axis);
    const Vec3 round = select(length2 > Float(0), from_axis * inverse_sqrt(max(length2, Float(1e-37f))), -d);

    // A ribbon is perpendicular to the ray except for its slope along the axis.
    const Float axis2 = max(dot(axis, axis), Float(1e-37f));
    const Vec3 facing = fma(axis, dot(d, axis) / axis2, -d);
    const Vec3 flat =
        select(dot(facing, facing) > Float(1e-6f), facing * inverse_sqrt(max(dot(facing, facing), Float(1e-37f))), -d);
    const Vec3 n = select(ribbon, flat, round);
    surface.ng = select(m, n, surface.ng);
    surface.ns = select(m, n, surface.ns);
    surface.p = select(m & !ribbon, fma(round, c.r, center), surface.p);
    surface.tangent = select(m, axis, surface.tangent);
    // A ray that leaves a ribbon must start farther away than half its width: the ribbon turns to face the new ray,
    // which would hit it again. For round curves the rounding of the intersection test determines the offset.
    const Float rounding = Float(0x1p-19f) * max(max_abs(surface.p), c.r);
    surface.offset = select(m, max(rounding, select(ribbon, c.r * Float(1.0625f), Float(0))), surface.offset);
    surface.radius = select(m, c.r, surface.radius);
    const Vec3 side = cross(axis, d);
    const Float across =
        dot(from_axis, side) * inverse_sqrt(max(dot(side, side), Float(1e-37f))) / max(c.r, Float(1e-30f));
    for (int i = 0; i < 2; ++i) {
        surface.at.u[i] = select(m, fma(u1 - u0, u, u0), surface.at.u[i]);
        surface.at.v[i] = select(m, clamp(fma(across, Float(0.5f), Float(0.5f)), Float(0), Float(1)), surface.at.v[i]);
    }
}

}  // namespace FATHOM_LANES
}  // namespace fathom
