#pragma once
#include "guiding/guidance.h"
#include "integrate/stages/shading_point.h"
#include "lights/sample/light_stage.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Closures whose narrowest facets stand for mirrors show no lights without extent in those.
template <class Closure>
inline BsdfEval eval_for_light(const Closure& closure, const Vec3& wo, const Vec3& wi, Mask has_no_extent)
{
    if constexpr (requires { closure.eval(wo, wi, has_no_extent); })
        return closure.eval(wo, wi, has_no_extent);
    else
        return closure.eval(wo, wi);
}

/// What a sampled light sends along a path of this throughput if nothing is in the way, weighted against what the
/// closure, with the guidance, might have sampled; of use in the lanes of `lit`, of which those stay to which the light
/// can be sent on.
template <class Closure>
[[gnu::always_inline]] inline Spectrum direct_light(const Closure& closure, const ShadingPoint<Closure>& at,
                                                    const Guidance& guidance, const LightSample& s,
                                                    const Spectrum& throughput, Mask& lit)
{
    const Vec3 wi = at.frame.to_local(s.wi);
    lit &= closure.has_non_delta() & equal(wi.z > Float(0), dot(s.wi, at.ng) > Float(0));
    if (!Closure::transmits) lit &= wi.z > Float(0);
    if (Closure::transmits) lit &= !at.skips_interface;
    const BsdfEval e = eval_for_light(closure, at.wo, wi, s.is_delta);
    const Float bsdf_pdf = guidance.is_on() ? guidance.pdf(s.wi, e.pdf) : e.pdf;
    return throughput * e.f_cos * s.radiance * light_weight(s, bsdf_pdf);
}

/// The shadow ray of such a sample. eye: where the light was seen from.
template <class Closure>
[[gnu::always_inline]] inline Ray shadow_ray(const ShadingPoint<Closure>& at, const Vec3& eye, const LightSample& s,
                                             Float time)
{
    const Vec3 o = Closure::transmits ? at.start(s.wi) : eye;
    // On the surface's other side the way is longer or shorter.
    const Float distance = Closure::transmits ? s.distance + dot(eye - o, s.wi) : s.distance;
    return {o, s.wi, distance * Float(1 - 0x1p-16f), time};
}

}  // namespace FATHOM_LANES
}  // namespace fathom
