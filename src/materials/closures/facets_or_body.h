// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"
#include "materials/lobes/lobe_choice.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Samples a closure of microfacets, which are chosen with probability p, on a diffuse body. eval() of the closure
/// gives the value and density of both.
template <class Closure>
BsdfSample reflection_of_facets_or_body(const Closure& closure, const Facets<Ggx>& facets, Float p, Vec3 wo, Sample2 u)
{
    LobeChoice choice(u.x);
    const Mask from_facets = choice.take(p);
    choice.take_rest(Float(1) - p);
    u.x = choice.stretched();
    const Vec3 wi = select(from_facets, reflect(wo, facets.sample(wo, u)), sample_cosine_hemisphere(u));
    return reflection(wi, closure.eval(wo, wi));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
