// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/lobes/sheen_albedo_table.h"
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Sheen lobe of fibers that stand on a surface, such as velvet: Estevez and Kulla 2017, "Production Friendly
/// Microfacet Sheen BRDF", with the visibility term of Ashikhmin and Premoze 2007. The lobe would reflect more light
/// than arrives at grazing angles, so it is divided by its albedo where that exceeds 1.
class SheenLobe {
public:
    explicit SheenLobe(Float roughness) : roughness_(max(roughness, Float(0.07f)))
    {
        inverse_alpha_ = Float(1) / (roughness_ * roughness_);
    }
    /// Directional albedo of a white sheen.
    Float albedo(Vec3 wo) const { return min(unscaled_albedo(wo), Float(1)); }
    /// BSDF of a white sheen times the cosine of wi, which is above the surface.
    Float eval(Vec3 wo, Vec3 wi) const
    {
        const Vec3 h = normalize(wo + wi + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Float sine2 = clamp(fma(h.x, h.x, h.y * h.y), Float(0), Float(1));
        const Float d = (Float(2) + inverse_alpha_) * Float(0.5f * inv_pi) * pow(sine2, inverse_alpha_ * Float(0.5f));
        const Float v = Float(0.25f) / max(fma(-wo.z, wi.z, wo.z + wi.z), Float(1e-4f));
        return d * v * wi.z / max(unscaled_albedo(wo), Float(1));
    }
    /// Samples the hemisphere uniformly, since most of the lobe's energy is near the horizon.
    static Vec3 sample(Sample2 u)
    {
        const Float s = sqrt(max(fma(-u.y, u.y, Float(1)), Float(0)));
        const SinCos phi = sincos_2pi(u.x);
        return {s * phi.cos, s * phi.sin, max(u.y, Float(1e-6f))};
    }
    /// Solid angle density of sample.
    static Float pdf() { return Float(0.5f * inv_pi); }

private:
    Float unscaled_albedo(Vec3 wo) const { return albedo_lookup(sheen_albedo_table, wo.z, roughness_); }

    Float roughness_, inverse_alpha_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
