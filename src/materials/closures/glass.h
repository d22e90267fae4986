// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parameters of GlassBsdf, with textures applied: see GlassRecord.
struct GlassPoint : FacetsPoint {
    using Record = GlassRecord;
    Float ior;
    Mask sheet{false};  ///< lanes with thin glass of two boundaries, between which light is reflected repeatedly
    Spectrum reflection_color{Float(1)};  ///< factor of reflections

    void read(const ParameterReader<Record>& r)
    {
        read_facets(r);
        ior = r.get(&Record::ior);
        sheet = r.has_flag(Record::sheet);
        const Mask tinted = r.has_flag(Record::tinted);
        if (any(tinted))
            reflection_color = r.color(&Record::reflection_color, &Record::reflection_color_texture, tinted);
    }
};

/// Refracts wo at the normal h. cos_o, cos_t: cosines of wo and of the refracted direction to h; eta: index beyond over
/// index before.
inline Vec3 refract(Vec3 wo, Vec3 h, Float cos_o, Float cos_t, Float eta)
{
    return h * (cos_o / eta - cos_t) - wo * (Float(1) / eta);
}

/// A dielectric boundary, smooth or of GGX microfacets: Walter et al. 2007, "Microfacet Models for Refraction through
/// Rough Surfaces". Refracted radiance scales by 1 / eta^2 and by the square root of the color, so that passing into a
/// solid and out of it applies the whole color.
///
/// A thin boundary transmits without bending, times the color; its facets spread transmission as they spread
/// reflection, mirrored to the other side. A sheet is two boundaries of reflectance r with nothing between them: the
/// series of interreflections sums to a reflectance of 2 r / (1 + r).
///
/// With energy compensation, reflection and refraction are both divided by their joint directional albedo, so that
/// multiple scattering between facets loses no energy (Turquin 2019). The closure is not reciprocal then.
class GlassBsdf : public ClosureOf<ClosureKind::glass, GlassPoint> {
public:
    static constexpr bool transmits = true;

    explicit GlassBsdf(const GlassPoint& m)
        : roughness_(sampled_roughness(m)),
          ggx_({max(sampled_alpha(m), Float(min_alpha))}, m.beckmann, m.separable),
          color_(m.base_color),
          reflected_(m.reflection_color),
          is_thin_(m.thin),
          is_sheet_(m.sheet),
          is_compensated_(m.compensated)
    {
        eta_ = select(m.entering | is_thin_, m.ior, Float(1) / m.ior);
        is_smooth_ = is_mirror(m.roughness);
        for (Float& c : color_.c) c = select(is_thin_, c, sqrt(max(c, Float(0))));
    }
    Mask has_non_delta() const { return !is_smooth_; }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Mask reflects = wi.z > Float(0);
        // A thin boundary uses the half vector of reflection for transmission too, with wi mirrored to the upper side.
        const Mask mirrors = reflects | is_thin_;
        wi.z = select(is_thin_, abs(wi.z), wi.z);
        Vec3 h = select(mirrors, wo + wi, fma(wi, eta_, wo));
        h = normalize(h + Vec3{Float(0), Float(0), Float(1e-20f)});
        h = flip_sign(h, h.z);
        const Float o = dot(wo, h), i = dot(wi, h);
        // Facets seen from behind scatter nothing: wo must be in front of the facet, and wi on the side it goes to.
        const Mask valid = has_non_delta() & (o > Float(0)) & equal(i > Float(0), mirrors);
        Float cos_t;
        const Float r = reflectance(min(o, Float(1)), cos_t);
        const Float share = select(reflects, r, Float(1) - r);
        const Float d = ggx_.d(h), visible = ggx_.g1(wo) * d / wo.z, facets = ggx_.value(h, d) * ggx_.g2(wo, wi);
        const Float denominator = i + o / eta_;
        const Float jacobian = abs(i) / max(denominator * denominator, Float(1e-20f));
        const Float f_mirror = share * facets / (Float(4) * wo.z);
        const Float f_refract = share * facets * jacobian * o / (wo.z * eta_ * eta_);
        const Float f = select(valid, select(mirrors, f_mirror, f_refract), Float(0));
        const Float pdf = select(valid, visible * share * select(mirrors, Float(0.25f), jacobian * o), Float(0));
        return {tint(reflects) * (f * gain(wo)), pdf};
    }
    /// Transmittance of a smooth sheet, without change of direction: the throughput of shadow rays.
    Spectrum passed(Vec3 wo) const
    {
        Float cos_t;
        return color_ * (Float(1) - reflectance(min(wo.z, Float(1)), cos_t));
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float u1) const
    {
        const Vec3 h = select(is_smooth_, Vec3{Float(0), Float(0), Float(1)}, ggx_.sample(wo, u));
        const Float o = clamp(dot(wo, h), Float(0), Float(1));
        Float cos_t;
        const Float r = reflectance(o, cos_t);
        const Mask reflects = u1 < r;
        const Vec3 mirrored = reflect(wo, h), straight{mirrored.x, mirrored.y, -mirrored.z};
        const Vec3 through = select(is_thin_, straight, refract(wo, h, o, cos_t, eta_));
        const Vec3 wi = normalize(select(reflects, mirrored, through));
        const Mask valid = equal(wi.z > Float(0), reflects);
        const Float g = select(is_smooth_, Float(1), ggx_.weight(wo, wi, h));
        const Mask refracts = !(reflects | is_thin_);
        const Float weight = select(refracts, g / (eta_ * eta_), g);
        const Float pdf = eval(wo, wi).pdf;
        return {wi, tint(reflects) * select(valid, weight * gain(wo), Float(0)), pdf, is_smooth_,
                select(refracts, eta_, Float(1))};
    }

private:
    Float reflectance(Float cosine, Float& cos_t) const
    {
        const Float r = fresnel_dielectric(cosine, eta_, cos_t);
        return select(is_sheet_, Float(2) * r / (Float(1) + r), r);
    }
    /// Energy compensation factor for multiple scattering between facets.
    Float gain(Vec3 wo) const
    {
        const Mask scaled = is_compensated_ & !is_smooth_;
        if (none(scaled)) return Float(1);
        const Float albedo = select(is_thin_, ggx_albedo(wo.z, roughness_), dielectric_albedo(wo.z, roughness_, eta_));
        return select(scaled, Float(1) / albedo, Float(1));
    }
    Spectrum tint(Mask reflects) const { return select(reflects, reflected_, color_); }

    Float roughness_;
    Facets<Ggx> ggx_;
    Spectrum color_, reflected_;  ///< colors of transmission and of reflection
    Float eta_;
    Mask is_thin_, is_sheet_, is_compensated_, is_smooth_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
