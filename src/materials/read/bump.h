// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Bump mapping: shading normals tilted by the slope of a height texture. Blinn 1978, "Simulation of Wrinkled
/// Surfaces".
#include "geometry/surface/surface_hit.h"
#include "kernel/tables.h"
#include "math/gather_member.h"
#include "textures/textures.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The texture lookup point displaced by `share` times the k-th parametric derivative of the surface.
inline TexturePoint displaced_lookup_point(const SceneTables& tables, const Surface& s, int k, Float share)
{
    TexturePoint at = s.at;
    at.p_world = fma(s.derivatives.way[k], share * Float(float(1 / tables.render_scale)), at.p_world);
    for (int set = 0; set < 2; ++set) {
        at.u[set] = fma(s.derivatives.du[k][set], share, at.u[set]);
        at.v[set] = fma(s.derivatives.dv[k][set], share, at.v[set]);
    }
    return at;
}

/// Tilts the shading normals of the lanes of m, whose materials are bump mapped. Blinn's term for the curvature of the
/// surface itself (height times dn/du) is omitted.
[[gnu::noinline]] inline void apply_bump_map(const SceneTables& tables, Mask m, Surface& s)
{
    const auto get = [&](auto NumberRecord::* member) {
        return gather(tables.materials, &MaterialRecord::bump, member, s.material, m);
    };
    const UInt texture = get(&NumberRecord::texture), channel = get(&NumberRecord::channel);
    const Float scale = get(&NumberRecord::value);
    const auto height = [&](const TexturePoint& at) {
        return evaluate_textures(tables, texture, at, m).channel(channel) * scale;
    };
    // The step is about a quarter of a pixel, since the camera is near the origin of render space. Far from the origin
    // of world space it grows with the spacing of floats.
    const Float step =
        max(max(max_abs(s.p), max_abs(s.at.p_world) * Float(float(tables.render_scale * 0.25))), Float(1e-3f)) *
        Float(0x1p-12f);
    const Float here = height(s.at);
    Vec3 bent[2];
    Mask known = m;
    for (int k = 0; k < 2; ++k) {
        const Vec3& way = s.derivatives.way[k];
        const Float length2 = dot(way, way);
        known = known & (length2 > Float(0));
        const Float share = step * inverse_sqrt(max(length2, Float(1e-30f)));
        const Float slope = (height(displaced_lookup_point(tables, s, k, share)) - here) / share;
        // Derivatives of the displaced position, in the tangent plane of the shading normal.
        bent[k] = fma(s.ns, slope - dot(way, s.ns), way);
    }
    const Vec3 n = cross(bent[0], bent[1]);
    known = known & (dot(n, n) > Float(0));
    const Float side = dot(cross(s.derivatives.way[0], s.derivatives.way[1]), s.ns);
    s.ns = select(known, flip_sign(normalize(n), side), s.ns);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
