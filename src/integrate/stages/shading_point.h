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

/// The shading normal, turned towards the geometric one as far as it takes for the mirror direction to leave the
/// surface; wo is on the side of ng.
///
/// In the plane of both normals, at an angle x from ng, with a and b the components of wo across and along ng, the
/// mirror direction rises by a sin 2x + b cos 2x = r cos(2x - p), where a = r sin p and b = r cos p. It shall rise by
/// t, at most b, which x = 0 gives: so 2x = p + acos(t / r). With less than b, rays that are mirrored again and again
/// inside glass would end up creeping along its surface, and never leave.
inline Vec3 bend_to_mirror(const Vec3& wo, const Vec3& ng, const Vec3& ns)
{
    const Float b = dot(wo, ng), cosine = dot(ns, ng);
    const Float t = min(b, Float(0.02f));
    const Mask below = Float(2) * dot(wo, ns) * cosine - b < t;
    if (none(below)) return ns;
    const Vec3 off = fma(ng, -cosine, ns);
    const Vec3 across = off * inverse_sqrt(max(dot(off, off), Float(1e-20f)));
    const Float a = dot(wo, across), inverse_r = inverse_sqrt(max(fma(a, a, b * b), Float(1e-20f)));
    const Float c = t * inverse_r, s = sqrt(max(fma(-c, c, Float(1)), Float(0)));
    const Float cos_2x = fma(b * inverse_r, c, -(a * inverse_r * s));
    const Float cos_x = sqrt(max(fma(cos_2x, Float(0.5f), Float(0.5f)), Float(0)));
    const Float sin_x = sqrt(max(fma(cos_2x, Float(-0.5f), Float(0.5f)), Float(0)));
    return select(below, fma(across, sin_x, ng * cos_x), ns);
}

/// Lanes where glass had better refract about its geometric normal: about ns light would stay on its side of the
/// surface, or be reflected totally though about ng it is not. What is mirrored about normals that are not the
/// surface's may come to be mirrored for ever, where light that came in through the surface itself would get out.
///
/// eta: index beyond over index before
inline Mask refracts_about_ng(const Vec3& wo, const Vec3& ng, const Vec3& ns, Float eta)
{
    const Float inverse = Float(1) / eta;
    const auto cos2_beyond = [&](Float cosine) {
        return fma(-(inverse * inverse), fma(-cosine, cosine, Float(1)), Float(1));
    };
    const Float by_ns = dot(wo, ns), by_ng = dot(wo, ng), cos2 = cos2_beyond(by_ns);
    const Float along_ns = fma(by_ns, inverse, -sqrt(max(cos2, Float(0))));
    const Mask back = fma(dot(ns, ng), along_ns, -(by_ng * inverse)) >= Float(0);
    const Mask passes = cos2 > Float(0);
    return (passes & back) | (!passes & (cos2_beyond(by_ng) > Float(0)));
}

/// Directions that rounding put below the horizon come back above it.
inline Vec3 upper(Vec3 w)
{
    return {w.x, w.y, max(w.z, Float(1e-4f))};
}

}  // namespace detail

template <class Closure>
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
    if constexpr (Closure::is_glossy) {
        ns = detail::bend_to_mirror(-hit.d, ng, ns);
        if constexpr (Closure::transmits) {
            const Float eta = select(facing > Float(0), point.ior, Float(1) / point.ior);
            ns = select(detail::refracts_about_ng(-hit.d, ng, ns, eta) & !point.thin, ng, ns);
        }
    } else {
        // Seen from behind its shading normal, a surface shows its geometric one.
        ns = select(dot(hit.d, ns) < Float(-1e-4f), ns, ng);
    }
    const Frame frame(ns);
    return {s.p, ng, s.offset, frame, detail::upper(frame.to_local(-hit.d)), material, point, facing <= Float(0)};
}

}  // namespace fathom::inline FATHOM_LANES
