#pragma once
/// What surfaces do with light. Directions are in the frame of the shading normal, unit, pointing away from the surface;
/// wo.z > 0: frames are turned to the side that the path is on.
///
/// A bsdf offers
///     BsdfEval eval(wo, wi)          what part of the light from wi goes to wo, times the cosine, and the density of sampling wi
///     BsdfSample sample(wo, u, u1)   a direction with its weight, f_cos / pdf
///     Mask has_smooth()              lanes with anything but delta lobes, for which lights are sampled
/// Delta lobes have a weight, and neither f_cos nor pdf.
#include "shading/microfacet.h"

namespace fathom::inline FATHOM_LANES {

struct BsdfEval {
    Spectrum f_cos;
    Float pdf;
};
struct BsdfSample {
    Vec3 wi;
    Spectrum weight;
    Float pdf;
    Mask is_delta;
    Float eta;  ///< index beyond over index before where the path is refracted, else 1
};

/// The parameters of a surface's material, textures applied.
struct MaterialPoint {
    Spectrum base_color;
    Float roughness, metallic, ior, fuzz;
    Mask entering;  ///< the path comes from the side of the geometric normal
};

/// Lambert's, or for roughness > 0 the energy-preserving Oren-Nayar of Portsmouth, Kutz and Hill 2024 ("EON"), whose
/// multiply scattered part makes up for what single scattering loses. Sampled by the cosine.
class DiffuseBsdf {
public:
    explicit DiffuseBsdf(const MaterialPoint& m) : color_(m.base_color), r_(clamp(m.roughness, Float(0), Float(1)))
    {
        is_rough_ = any(r_ > Float(0));
    }
    Mask has_smooth() const { return Mask(true); }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Float cosine = max(wi.z, Float(0));
        return {f(wo, wi) * cosine, cosine * Float(inv_pi)};
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float) const
    {
        const Vec3 wi = sample_cosine_hemisphere(u);
        return {wi, f(wo, wi) * Float(pi), wi.z * Float(inv_pi), Mask(false), Float(1)};
    }

private:
    /// Share of light reflected by single scattering for albedo 1: eq. 30 of the paper, the fitted form.
    Float single_albedo(Float cosine) const
    {
        const Float m = Float(1) - cosine;
        const Float g = m * fma(m, fma(m, fma(m, Float(0.0571085289f), Float(-0.332181442f)), Float(0.491881867f)), Float(0.0571085289f) * Float(0));
        return g;
    }
    Spectrum f(Vec3 wo, Vec3 wi) const;

    Spectrum color_;
    Float r_;
    bool is_rough_;
};

}  // namespace fathom::inline FATHOM_LANES
