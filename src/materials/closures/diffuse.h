// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Lambertian reflection, or for roughness > 0 the energy-preserving Oren-Nayar model of Portsmouth, Kutz and Hill 2024
/// ("EON"), whose multiple-scattering term restores the energy that single scattering loses. Sampled by the cosine.
class DiffuseBsdf : public ClosureOf<ClosureKind::diffuse, RoughPoint> {
public:
    static constexpr bool is_glossy = false;
    static constexpr bool is_guided = true;

    explicit DiffuseBsdf(const RoughPoint& m) : color_(m.base_color), r_(m.roughness)
    {
        is_rough_ = any(r_ > Float(0));
    }
    Float guided_weight() const { return Float(1); }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Float cosine = max(wi.z, Float(0));
        return {pi_f(wo, wi) * (cosine * Float(inv_pi)), cosine * Float(inv_pi)};
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float) const
    {
        const Vec3 wi = sample_cosine_hemisphere(u);
        return {wi, pi_f(wo, wi), wi.z * Float(inv_pi), Mask(false), Float(1)};
    }

private:
    static constexpr float c1 = 0.5f - 2 * inv_pi / 3, c2 = 2.0f / 3 - 28 * inv_pi / 15;

    /// Directional albedo of single scattering for a white surface, by the paper's polynomial fit.
    Float single_albedo(Float cosine) const
    {
        const Float m = Float(1) - cosine;
        Float g = fma(m, Float(0.0714429953f), Float(-0.332181442f));
        g = fma(m, g, Float(0.491881867f));
        g = m * fma(m, g, Float(0.0571085289f));
        return fma(r_, g, Float(1)) / fma(r_, Float(c1), Float(1));
    }
    /// BSDF times pi.
    Spectrum pi_f(Vec3 wo, Vec3 wi) const
    {
        if (!is_rough_) return color_;
        const Float cos_i = max(wi.z, Float(1e-6f)), cos_o = max(wo.z, Float(1e-6f));
        const Float s = fma(wo.x, wi.x, wo.y * wi.y);
        const Float st = select(s > Float(0), s / max(cos_i, cos_o), s);
        const Float norm = Float(1) / fma(r_, Float(c1), Float(1));
        const Float single = norm * fma(r_, st, Float(1));
        const Float mean = fma(r_, Float(c2), Float(1)) * norm;
        const Float lost = max(Float(1) - mean, Float(1e-7f));
        const Float multiple = (Float(1) - single_albedo(cos_o)) * (Float(1) - single_albedo(cos_i)) / lost;
        Spectrum f;
        for (int i = 0; i < channels; ++i) {
            const Float c = color_.c[i];
            f.c[i] = c * fma(c * mean / fma(-c, lost, Float(1)), multiple, single);
        }
        return f;
    }

    Spectrum color_;
    Float r_;
    bool is_rough_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
