// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parameters of MetalBsdf, with textures applied: see MetalRecord.
struct MetalPoint : FacetsPoint {
    using Record = MetalRecord;

    void read(const ParameterReader<Record>& r) { read_facets(r); }
};

/// A conductor: GGX microfacets with Schlick's reflectance, scaled to compensate for multiple scattering (Turquin 2019,
/// "Practical multiple scattering compensation for microfacet models"). It is a mirror if alpha is below min_alpha.
class MetalBsdf : public ClosureOf<ClosureKind::metal, MetalPoint> {
public:
    static constexpr bool is_guided = true;

    explicit MetalBsdf(const MetalPoint& m)
        : color_(m.base_color),
          roughness_(sampled_roughness(m)),
          ggx_({max(sampled_alpha(m), Float(min_alpha))}, m.beckmann, m.separable),
          is_mirror_(is_mirror(m.roughness))
    {
    }
    Mask has_non_delta() const { return !is_mirror_; }
    Float guided_weight() const { return select(is_mirror_, Float(0), min(Float(2) * roughness_, Float(1))); }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Vec3 h = normalize(wo + wi + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Mask valid = (wi.z > Float(0)) & has_non_delta();
        const Float d = ggx_.d(h);
        const Float f = select(valid, ggx_.value(h, d) * ggx_.g2(wo, wi) / (Float(4) * wo.z), Float(0));
        const Float pdf = select(valid, ggx_.g1(wo) * d / (Float(4) * wo.z), Float(0));
        return {reflectance(wo, dot(wo, h)) * f, pdf};
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float) const
    {
        const Vec3 h = select(is_mirror_, Vec3{Float(0), Float(0), Float(1)}, ggx_.sample(wo, u));
        const Vec3 wi = reflect(wo, h);
        const Float g = select(is_mirror_, Float(1), ggx_.weight(wo, wi, h));
        const Float pdf = ggx_.g1(wo) * ggx_.d(h) / (Float(4) * wo.z);
        return {wi, reflectance(wo, dot(wo, h)) * select(wi.z > Float(0), g, Float(0)), pdf, is_mirror_, Float(1)};
    }

private:
    Spectrum reflectance(Vec3 wo, Float cos_h) const
    {
        const Float w = schlick_weight(cos_h);
        const Float e = select(is_mirror_, Float(1), ggx_albedo(wo.z, roughness_));
        const Float more = (Float(1) - e) / e;
        Spectrum r;
        for (int i = 0; i < channels; ++i) {
            const Float c = color_.c[i];
            r.c[i] = fma(Float(1) - c, w, c) * fma(c, more, Float(1));
        }
        return r;
    }

    Spectrum color_;
    Float roughness_;
    Facets<Ggx> ggx_;
    Mask is_mirror_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
