#pragma once
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The clear coat of Burley 2012, "Physically Based Shading at Disney": facets distributed as GTR of exponent 1, whose
/// highlights have wide tails, Schlick's reflectance of index 1.5, and the shadowing of GGX of alpha 0.25.
class Gtr1Coat {
public:
    /// gloss: 0 for an alpha of 0.1, to 1 for one of 0.001
    explicit Gtr1Coat(Float gloss)
    {
        const Float alpha = fma(gloss, Float(0.001f - 0.1f), Float(0.1f));
        alpha2_ = alpha * alpha;
        log_alpha2_ = log(alpha2_);
        scale_ = (alpha2_ - Float(1)) * Float(inv_pi) / log_alpha2_;
    }
    /// What it reflects of light to a direction, about.
    static Float albedo(Float cosine) { return reflectance(cosine) * cosine; }
    /// The bsdf times the cosine, and the density of sample; wo and wi are above the surface.
    void eval(const Vec3& wo, const Vec3& wi, Float& f_cos, Float& pdf) const
    {
        const Vec3 h = normalize(wo + wi + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Float cos_d = max(dot(wo, h), Float(1e-6f)), normals = d(h);
        const Ggx shadowing{Float(0.25f)};
        // Burley's code has no 1 / (4 cos cos) here: it is in what the coat's strength means.
        f_cos = Float(0.25f) * reflectance(cos_d) * normals * shadowing.g1(wo) * shadowing.g1(wi) * wi.z;
        pdf = normals * h.z / (Float(4) * cos_d);
    }
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
        // Without what cancels near the normal.
        const Float sine2 = fma(h.x, h.x, h.y * h.y);
        return scale_ / max(fma(alpha2_, h.z * h.z, sine2), Float(1e-30f));
    }

    Float alpha2_, log_alpha2_, scale_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
