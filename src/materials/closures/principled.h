// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"
#include "materials/closures/facets_or_body.h"
#include "materials/lobes/channel_weights.h"
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The metallic-roughness model of glTF 2.0 (appendix B): a mixture by `metallic` of a metal and of a dielectric, which
/// is a diffuse base under a specular layer. Metal and layer have the same GGX microfacets. With energy compensation
/// each is scaled by itself for multiple scattering, because the factor is not linear in the reflectance.
/// The base is attenuated by the layer's directional albedo; glTF's formula takes the reflectance at the half vector,
/// which creates energy at grazing angles.
class PrincipledBsdf : public ClosureOf<ClosureKind::principled, PrincipledPoint> {
public:
    static constexpr bool is_guided = true;

    explicit PrincipledBsdf(const PrincipledPoint& m)
        : roughness_(sampled_roughness(m)),
          ggx_({max(sampled_alpha(m), Float(2 * min_alpha))}, m.beckmann, m.separable),
          mirrors_(is_mirror(m.roughness)),
          metallic_(m.metallic),
          compensation_(select(m.compensated, Float(1), Float(0))),
          color_(m.base_color)
    {
        const Float r = (m.ior - Float(1)) / (m.ior + Float(1));
        dielectric_f0_ = r * r;
        const Float color = ChannelWeights(color_).norm(color_);
        f0_ = fma(metallic_, max(color, dielectric_f0_) - dielectric_f0_, dielectric_f0_);
        diffuse_ = color * (Float(1) - metallic_);
    }
    Float guided_weight() const { return fma(metallic_, min(Float(2) * roughness_, Float(1)) - Float(1), Float(1)); }
    BsdfEval eval(Vec3 wo, Vec3 wi, Mask without_mirrors = Mask(false)) const
    {
        const Vec3 h = normalize(wo + wi + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Mask valid = wi.z > Float(0);
        const Float d = ggx_.d(h);
        const Float specular =
            select(without_mirrors & mirrors_, Float(0), ggx_.value(h, d) * ggx_.g2(wo, wi) / (Float(4) * wo.z));
        const Float w = schlick_weight(dot(wo, h));
        const Float more = gain(ggx_albedo(wo.z, roughness_));
        const auto reflected = [&](Float f0) { return fma(Float(1) - f0, w, f0) * fma(f0, more, Float(1)); };
        const Float cosine = wi.z * Float(inv_pi);
        const Float base = (Float(1) - layer_albedo(wo.z)) * cosine;
        const Float layer = reflected(dielectric_f0_) * specular;
        const Float p = specular_probability(wo);
        BsdfEval r;
        for (int i = 0; i < channels; ++i) {
            const Float dielectric = fma(base, color_.c[i], layer), metal = reflected(color_.c[i]) * specular;
            r.f_cos.c[i] = select(valid, fma(metallic_, metal - dielectric, dielectric), Float(0));
        }
        r.pdf = select(valid, fma(p, ggx_.g1(wo) * d / (Float(4) * wo.z), (Float(1) - p) * cosine), Float(0));
        return r;
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float) const
    {
        return reflection_of_facets_or_body(*this, ggx_, specular_probability(wo), wo, u);
    }

private:
    /// Compensation factor minus 1 of a white surface. e: single-scattering albedo of its microfacets.
    Float gain(Float e) const { return compensation_ * (Float(1) - e) / e; }
    /// Directional albedo of the specular layer, by the tables.
    Float layer_albedo(Float cosine) const
    {
        const Float e = ggx_albedo(cosine, roughness_), w = albedo_lookup(ggx_schlick_table, cosine, roughness_);
        const Float once = fma(dielectric_f0_, e - w, w);
        return clamp(once * fma(dielectric_f0_, gain(e), Float(1)), Float(0), Float(1));
    }
    Float specular_probability(Vec3 wo) const
    {
        const Float s = fma(Float(1) - f0_, schlick_weight(wo.z), f0_);
        const Float d = diffuse_ * (Float(1) - s);
        return select(d > Float(0), clamp(s / (s + d), Float(0.1f), Float(0.9f)), Float(1));
    }

    Float roughness_;
    Facets<Ggx> ggx_;
    Mask mirrors_;
    Float metallic_, compensation_, dielectric_f0_;
    Float f0_, diffuse_;  ///< approximate albedos of the lobes, weighted over channels
    Spectrum color_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
