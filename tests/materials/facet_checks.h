// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closure_checks.h"
#include "materials/closures/glass.h"
#include "materials/closures/metal.h"
#include "materials/closures/plastic.h"
#include "materials/closures/principled.h"

namespace fathom::test {

/// A material without energy compensation, whose microfacets have a property.
inline CommonPoint with_facets(Mask FacetsPoint::* property, float color, float roughness, float metallic)
{
    CommonPoint m = material(color, roughness, metallic);
    m.*property = Mask(true);
    m.compensated = Mask(false);
    return m;
}

/// Checks the sampling of each closure with isotropic microfacets.
inline void check_facet_sampling(const CommonPoint& m, double degrees)
{
    check_sampling(PlasticBsdf(m), degrees, "plastic");
    check_sampling(MetalBsdf(m), degrees, "metal");
    check_sampling(PrincipledBsdf(m), degrees, "principled");
    check_sampling(GlassBsdf(m), degrees, "glass");
}

}  // namespace fathom::test
