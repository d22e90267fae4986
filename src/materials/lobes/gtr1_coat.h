// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Clear coat lobe of Burley 2012, "Physically Based Shading at Disney": GTR distribution of exponent 1, whose
/// highlights have wide tails, Schlick's reflectance of index 1.5, and the shadowing of GGX with alpha 0.25. Directions
/// are in the frame of the shading normal.
class Gtr1Coat {
public:
    /// gloss: in [0, 1]; alpha is 0.1 for a gloss of 0, and 0.001 for 1
    explicit Gtr1Coat(Float gloss)
    {
        const Float alpha = fma(gloss, Float(0.001f - 0.1f), Float(0.1f));
        alpha2_ = alpha * alpha;
        log_alpha2_ = log(alpha2_);
        scale_ = (alpha2_ - Float(1)) * Float(inv_pi) / log_alpha2_;
    }
    /// Approximate directional albedo, for lobe selection.
    static Float albedo(Float cosine) { return reflectance(cosine) * cosine; }
    /// BSDF times cosine (f_cos), and the solid angle density of sample; wo and wi are above the surface.
    void eval(const Vec3& wo, const Vec3& wi, Float& f_cos, Float& pdf) const
    {
        const Vec3 h = normalize(wo + wi + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Float cos_d = max(dot(wo, h), Float(1e-6f)), normals = d(h);
        const Ggx shadowing{Float(0.25f)};
        // Burley's code omits the usual 1 / (4 cos cos), which the coat's strength includes.
        f_cos = Float(0.25f) * reflectance(cos_d) * normals * shadowing.g1(wo) * shadowing.g1(wi) * wi.z;
        pdf = normals * h.z / (Float(4) * cos_d);
    }
    /// Samples wi by the distribution of normals. The direction can lie below the surface.
    Vec3 sample(const Vec3& wo, Sample2 u) const
    {
        const Float power = exp(log_alpha2_ * (Float(1) - u.y));
        const Float cos2 = clamp((Float(1) - power) / (Float(1) - alpha2_), Float(0), Float(1));
        const Float sine = sqrt(max((power - alpha2_) / (Float(1) - alpha2_), Float(0)));
        const SinCos phi = sincos_2pi(u.x);
        return reflect(wo, {sine * phi.cos, sine * phi.sin, sqrt(cos2)});
    }

private:
    static Float reflectance(Float cosine) { return fma(schlick_weight(cosine), Float(0.96f), Float(0.04f)); }
    Float d(const Vec3& h) const
    {
        // This form of 1 + (alpha^2 - 1) cos^2 avoids cancellation near the normal.
        const Float sine2 = fma(h.x, h.x, h.y * h.y);
        return scale_ / max(fma(alpha2_, h.z * h.z, sine2), Float(1e-30f));
    }

    Float alpha2_, log_alpha2_, scale_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
