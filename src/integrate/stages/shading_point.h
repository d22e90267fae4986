#pragma once
#include "integrate/stages/material.h"

namespace fathom::inline FATHOM_LANES {

/// Where a path meets a surface: place and frame turned to the side that the path is on, and the material there.
struct ShadingPoint {
    Vec3 p, ng;
    Float offset;  ///< see Surface
    Frame frame;   ///< of the shading normal
    Vec3 wo;       ///< to where the path came from, in the frame
    UInt material_index;
    MaterialPoint material;
    Mask inside;  ///< the path came from behind the geometric normal

    /// Where a ray begins that leaves along wi.
    template <class Closure>
    [[gnu::always_inline]] Vec3 start(const Vec3& wi) const
    {
        const Vec3 side = Closure::transmits ? flip_sign(ng, dot(wi, ng)) : ng;
        return fma(side, offset, p);
    }
};

namespace detail {

/// Directions that rounding put below the horizon come back above it.
inline Vec3 upper(Vec3 w)
{
    return {w.x, w.y, max(w.z, Float(1e-4f))};
}

}  // namespace detail

[[gnu::always_inline]] inline ShadingPoint read_shading_point(const SurfaceReader& surfaces,
                                                              const MaterialReader& materials, const SurfaceHit& hit,
                                                              Mask m)
{
    Surface s = surfaces.read(hit, m);
    const UInt material = surfaces.material_of(s.shape, m);
    const Float facing = -dot(hit.d, s.ng);
    const MaterialPoint point = materials.read(s, material, facing > Float(0), m);
    const Vec3 ng = flip_sign(s.ng, facing);
    Vec3 ns = flip_sign(s.ns, facing);
    // Seen from behind its shading normal, a surface shows its geometric one.
    ns = select(dot(hit.d, ns) < Float(-1e-4f), ns, ng);
    const Frame frame(ns);
    return {s.p, ng, s.offset, frame, detail::upper(frame.to_local(-hit.d)), material, point, facing <= Float(0)};
}

}  // namespace fathom::inline FATHOM_LANES
