#pragma once
#include "shading/closures/closure.h"
#include "shading/microfacet.h"

namespace fathom::inline FATHOM_LANES {

/// The metallic-roughness model of glTF 2.0 (its appendix B): a diffuse base under a specular layer of GGX facets,
/// mixed with a metal. The specular part is scaled for multiple scattering, as the metal's; the base gets what the
/// layer's directional albedo leaves (where glTF's own formula takes the half vector's reflectance, and makes energy at
/// grazing angles).
class PrincipledBsdf {
public:
    static constexpr MaterialKind kind = MaterialKind::principled;
    static constexpr bool transmits = false;

    explicit PrincipledBsdf(const MaterialPoint& m)
        : roughness_(m.roughness), ggx_{max(m.roughness * m.roughness, Float(2 * min_alpha))}, metallic_(m.metallic)
    {
        const Float r = (m.ior - Float(1)) / (m.ior + Float(1));
        Float most_f0(0.f), most_diffuse(0.f);
        for (int i = 0; i < channels; ++i) {
            dielectric_f0_ = r * r;
            f0_.c[i] = fma(metallic_, m.base_color.c[i] - r * r, r * r);
            diffuse_.c[i] = m.base_color.c[i] * (Float(1) - metallic_);
            most_f0 = max(most_f0, f0_.c[i]);
            most_diffuse = max(most_diffuse, diffuse_.c[i]);
        }
        most_f0_ = most_f0;
        most_diffuse_ = most_diffuse;
    }
    Mask has_smooth() const { return Mask(true); }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Vec3 h = normalize(wo + wi + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Mask valid = wi.z > Float(0);
        const Float d = ggx_.d(h);
        const Float specular = d * ggx_.g2(wo, wi) / (Float(4) * wo.z);
        const Float w = schlick_weight(dot(wo, h));
        const Float e = ggx_albedo(wo.z, roughness_), more = (Float(1) - e) / e;
        const Float cosine = wi.z * Float(inv_pi);
        const Float base = (Float(1) - layer_albedo(wo.z)) * cosine;
        const Float p = specular_probability(wo);
        BsdfEval r;
        for (int i = 0; i < channels; ++i) {
            const Float fresnel = fma(Float(1) - f0_.c[i], w, f0_.c[i]);
            const Float f = fma(fresnel * fma(f0_.c[i], more, Float(1)), specular, base * diffuse_.c[i]);
            r.f_cos.c[i] = select(valid, f, Float(0));
        }
        r.pdf = select(valid, fma(p, ggx_.g1(wo) * d / (Float(4) * wo.z), (Float(1) - p) * cosine), Float(0));
        return r;
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float u1) const
    {
        const Mask specular = u1 < specular_probability(wo);
        const Vec3 wi = select(specular, reflect(wo, ggx_.sample(wo, u)), sample_cosine_hemisphere(u));
        const BsdfEval e = eval(wo, wi);
        return {wi, e.f_cos * select(e.pdf > Float(0), Float(1) / max(e.pdf, Float(1e-30f)), Float(0)), e.pdf,
                Mask(false), Float(1)};
    }

private:
    /// Directional albedo of the specular layer, by the tables.
    Float layer_albedo(Float cosine) const
    {
        const Float e = ggx_albedo(cosine, roughness_), w = ggx_lookup(ggx_schlick_table, cosine, roughness_);
        const Float once = fma(dielectric_f0_, e - w, w);
        return clamp(once * fma(dielectric_f0_, (Float(1) - e) / e, Float(1)), Float(0), Float(1));
    }
    Float specular_probability(Vec3 wo) const
    {
        const Float s = fma(Float(1) - most_f0_, schlick_weight(wo.z), most_f0_);
        const Float d = most_diffuse_ * (Float(1) - s);
        return select(d > Float(0), clamp(s / (s + d), Float(0.1f), Float(0.9f)), Float(1));
    }

    Float roughness_;
    Ggx ggx_;
    Float metallic_, dielectric_f0_, most_f0_, most_diffuse_;
    Spectrum f0_, diffuse_;
};

}  // namespace fathom::inline FATHOM_LANES
