// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "guiding/guidance.h"
#include "integrate/stages/shading_point.h"
#include "lights/sample/light_stage.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Evaluates a closure for sampled lights. Narrow lobes that stand in for mirrors reflect no delta lights.
template <class Closure>
inline BsdfEval eval_for_light(const Closure& closure, const Vec3& wo, const Vec3& wi, Mask has_no_extent)
{
    if constexpr (requires { closure.eval(wo, wi, has_no_extent); })
        return closure.eval(wo, wi, has_no_extent);
    else
        return closure.eval(wo, wi);
}

/// Next event estimation: contribution of a light sample to a path of this throughput if unoccluded, MIS-weighted
/// against sampling by the closure and the guidance. Valid in the lanes of `lit`; clears lanes to which the closure
/// cannot scatter the light. scatter_pdf: set to the density of the closure alone.
template <class Closure>
[[gnu::always_inline]] inline Spectrum direct_light(const Closure& closure, const ShadingPoint<Closure>& at,
                                                    const Guidance& guidance, const LightSample& s,
                                                    const Spectrum& throughput, Mask& lit, Float& scatter_pdf)
{
    const Vec3 wi = at.frame.to_local(s.wi);
    lit &= closure.has_non_delta() & equal(wi.z > Float(0), dot(s.wi, at.ng) > Float(0));
    if (!Closure::transmits) lit &= wi.z > Float(0);
    if (Closure::transmits) lit &= !at.skips_interface;
    const BsdfEval e = eval_for_light(closure, at.wo, wi, s.is_delta);
    scatter_pdf = e.pdf;
    const Float bsdf_pdf = guidance.is_on() ? guidance.pdf(s.wi, e.pdf) : e.pdf;
    return throughput * e.f_cos * s.radiance * light_weight(s, bsdf_pdf);
}

/// Shadow ray of a light sample. eye: the point from which the light was sampled; time: of the ray.
template <class Closure>
[[gnu::always_inline]] inline Ray shadow_ray(const ShadingPoint<Closure>& at, const Vec3& eye, const LightSample& s,
                                             Float time)
{
    const Vec3 o = Closure::transmits ? at.start(s.wi) : eye;
    // If the direction leads to the other side of the surface, the distance to the light differs by the offset of the
    // origin.
    const Float distance = Closure::transmits ? s.distance + dot(eye - o, s.wi) : s.distance;
    return {o, s.wi, distance * Float(1 - 0x1p-16f), time};
}

}  // namespace FATHOM_LANES
}  // namespace fathom
