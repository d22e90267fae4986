// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/glass.h"
#include "materials/lobes/channel_weights.h"
#include "materials/lobes/gtr1_coat.h"
#include "materials/lobes/lobe_choice.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The Disney BSDF: Burley 2012, "Physically Based Shading at Disney", and 2015, "Extending the Disney BRDF to a BSDF
/// with Integrated Subsurface Scattering". Lobes are added without attenuating each other, so albedos can slightly
/// exceed 1. Microfacets are anisotropic GGX with separable shadowing.
///
/// On solids the diffuse lobe, coat and sheen are on the outside only; microfacets reflect and refract on both sides.
/// An opaque surface encloses no solid: its back reflects as its front. Thin surfaces have no metal and no coat; they
/// reflect, transmit without bending, and transmit diffusely.
///
/// passes  whether any lobe transmits
template <bool passes>
class DisneyBsdf
    : public ClosureOf<passes ? ClosureKind::disney_transmitting : ClosureKind::disney, DisneyMaterialPoint> {
public:
    static constexpr bool transmits = passes;
    static constexpr bool is_guided = !passes;

    explicit DisneyBsdf(const DisneyMaterialPoint& m)
        : d_(m.disney),
          color_(m.base_color),
          weights_(m.base_color),
          roughness_(m.roughness),
          metallic_(select(m.thin, Float(0), m.metallic)),
          eta_(passes ? select(m.entering | m.thin, m.ior, Float(1) / m.ior) : m.ior),
          thin_(m.thin),
          inside_(passes ? !m.entering & !m.thin : Mask(false)),
          coat_(m.disney.coat_gloss),
          axes_(select(m.disney.anisotropy > Float(0), m.disney.tangent, Vec3(Float(0), Float(0), Float(0))))
    {
        // With equal indices on both sides the half vector of refraction is undefined.
        eta_ = select(abs(eta_ - Float(1)) < Float(5e-4f), Float(1 + 5e-4f), eta_);
        const Float aspect = sqrt(fma(d_.anisotropy, Float(-0.9f), Float(1)));
        facets_ = facets(roughness_, aspect);
        mirrors_ = is_mirror(roughness_);
        if (passes && any(thin_)) thin_facets_ = facets(fma(m.ior, Float(0.65f), Float(-0.35f)) * roughness_, aspect);
        const Float opaque = (Float(1) - metallic_) * (Float(1) - d_.transmission);
        refracted_ = (Float(1) - metallic_) * d_.transmission;
        diffuse_ = select(inside_, Float(0), opaque * select(thin_, Float(1) - d_.diffuse_transmission, Float(1)));
        diffuse_transmission_ = select(thin_, opaque * d_.diffuse_transmission, Float(0));
        sheen_ = select(diffuse_ > Float(0), d_.sheen * select(thin_, diffuse_, Float(1) - metallic_), Float(0));
        // Thin surfaces reflect specularly only as much as they refract.
        reflected_ = select(inside_ | thin_, refracted_, Float(1));
        coated_ = select(inside_ | thin_, Float(0), d_.coat);
        const Float luminance =
            fma(color_.c[0], Float(0.2126f), fma(color_.c[1], Float(0.7152f), color_.c[2] * Float(0.0722f)));
        for (int i = 0; i < channels; ++i) {
            tint_.c[i] = select(luminance > Float(0), color_.c[i] / max(luminance, Float(1e-20f)), Float(1));
            through_.c[i] = select(thin_, color_.c[i], sqrt(max(color_.c[i], Float(0)))) * refracted_;
        }
    }
    Float guided_weight() const { return fma(metallic_, min(Float(2) * roughness_, Float(1)) - Float(1), Float(1)); }
    BsdfEval eval(Vec3 wo, Vec3 wi, Mask without_mirrors = Mask(false)) const
    {
        return eval(chances(wo), wo, wi, without_mirrors);
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float) const
    {
        const Chances c = chances(wo);
        LobeChoice choice(u.x);
        const Mask reflected = choice.take(c.reflected), coated = choice.take(c.coat);
        Mask goes_through(false), diffusely(false);
        if constexpr (passes) goes_through = choice.take(c.refracted), diffusely = choice.take(c.beyond);
        choice.take_rest(c.diffuse);
        u.x = choice.stretched();

        const Vec3 o = axes_.to_facets(wo);
        Vec3 wi = sample_cosine_hemisphere(u);
        const Vec3 h = axes_.from_facets(facets_.sample(o, u));
        wi = select(reflected, reflect(wo, h), wi);
        if (any(coated)) wi = select(coated, coat_.sample(wo, u), wi);
        Mask refracted(false), goes_beyond(false), total(false);
        if constexpr (passes) {
            goes_beyond = goes_through;
            refracted = goes_beyond & !thin_;
            if (any(goes_beyond)) wi = select(goes_beyond, sample_through(wo, o, h, u, refracted, total), wi);
            wi.z = select(diffusely, -wi.z, wi.z);
            goes_beyond |= diffusely;
        }
        const BsdfEval e = eval(c, wo, wi, Mask(false));
        // Directions on the wrong side and total internal reflection get weight 0: the density there belongs to other
        // lobes.
        const Mask kept = (e.pdf > Float(0)) & equal(wi.z < Float(0), goes_beyond) & !total;
        const Float inverse = select(kept, Float(1) / max(e.pdf, Float(1e-30f)), Float(0));
        return {wi, e.f_cos * inverse, e.pdf, Mask(false), passes ? select(refracted, eta_, Float(1)) : Float(1)};
    }

private:
    using FacetsOf = Facets<AnisotropicGgx>;
    /// Selection probabilities of the lobes; diffuse takes the remainder.
    struct Chances {
        Float reflected, coat, refracted, beyond, diffuse;
    };

    static FacetsOf facets(Float roughness, Float aspect)
    {
        const Float alpha = roughness * roughness;
        return {{max(alpha / aspect, Float(2 * min_alpha)), max(alpha * aspect, Float(2 * min_alpha))},
                Mask(false),
                Mask(true)};
    }
    /// Fresnel reflectance of the dielectric boundary (returned), and the colored reflectance of the whole specular
    /// lobe (`all`), which mixes dielectric, tinted and metallic reflection.
    Float reflectance(Float cosine, Spectrum& all) const
    {
        Float cos_t;
        const Float dielectric = fresnel_dielectric(clamp(cosine, Float(0), Float(1)), eta_, cos_t);
        const Float w = schlick_weight(select(eta_ > Float(1), cosine, cos_t));
        const Float root = (eta_ - Float(1)) / (eta_ + Float(1)), f0 = root * root;
        const Float tinted = select(inside_, Float(0), (Float(1) - metallic_) * d_.specular_tint);
        const Float metal = select(inside_, Float(0), metallic_), plain = Float(1) - metal - tinted;
        for (int i = 0; i < channels; ++i) {
            const auto schlick = [&](Float normal) { return fma(w, Float(1) - normal, normal); };
            const Float mixed = fma(metal, schlick(color_.c[i]), tinted * schlick(tint_.c[i] * f0));
            all.c[i] = fma(plain, dielectric, mixed) * reflected_;
        }
        return dielectric;
    }
    /// Selection probabilities in proportion to approximate albedos, whose channels are weighted (ChannelWeights). The
    /// specular lobe has a minimum, because it is narrow and may reflect bright light.
    Chances chances(const Vec3& wo) const
    {
        Spectrum reflected;
        const Float dielectric = reflectance(wo.z, reflected), body = weights_.norm(color_);
        Chances c;
        c.diffuse = fma(diffuse_, body, sheen_ * Float(0.15f));
        c.coat = coated_ * Gtr1Coat::albedo(wo.z);
        c.refracted = c.beyond = Float(0);
        if constexpr (passes) {
            c.refracted = weights_.norm(through_) * max(Float(1) - dielectric, Float(0.05f));
            c.beyond = diffuse_transmission_ * body;
        }
        const Float others = c.diffuse + c.coat + c.refracted + c.beyond;
        c.reflected = select(reflected_ > Float(0), max(weights_.norm(reflected), Float(0.1f) * others), Float(0));
        const Float total = others + c.reflected, scale = Float(1) / max(total, Float(1e-20f));
        c.reflected = c.reflected * scale, c.coat = c.coat * scale, c.refracted = c.refracted * scale;
        c.beyond = c.beyond * scale;
        c.diffuse = max(Float(1) - c.reflected - c.coat - c.refracted - c.beyond, Float(0));
        return c;
    }
    /// Samples a direction through the surface. wo: in the shading frame; o: in the frame of the facets; h: sampled
    /// normal, in the shading frame. total: receives the lanes of total internal reflection.
    Vec3 sample_through(const Vec3& wo, const Vec3& o, const Vec3& h, Sample2 u, Mask refracted, Mask& total) const
    {
        const Float cosine = clamp(dot(wo, h), Float(0), Float(1));
        Float cos_t;
        fresnel_dielectric(cosine, eta_, cos_t);
        total = refracted & !(cos_t > Float(0));
        const Vec3 wi = normalize(refract(wo, h, cosine, cos_t, eta_));
        if (none(thin_)) return wi;
        const Vec3 mirrored = reflect(wo, axes_.from_facets(thin_facets_.sample(o, u)));
        return select(thin_, Vec3{mirrored.x, mirrored.y, -mirrored.z}, wi);
    }

    BsdfEval eval(const Chances& c, const Vec3& wo, const Vec3& wi, Mask without_mirrors) const
    {
        const Mask above = wi.z > Float(0);
        BsdfEval r = reflected(c, wo, wi, without_mirrors), beyond{Spectrum(Float(0)), Float(0)};
        if constexpr (passes) beyond = passed(c, wo, wi, without_mirrors);
        return {select(above, r.f_cos, beyond.f_cos), select(above, r.pdf, beyond.pdf)};
    }
    /// f_cos and pdf of wi above the surface.
    BsdfEval reflected(const Chances& c, const Vec3& wo, const Vec3& wi, Mask without_mirrors) const
    {
        const Vec3 o = axes_.to_facets(wo), i = axes_.to_facets(wi);
        const Vec3 h = normalize(o + i + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Float cos_d = max(dot(o, h), Float(0)), normals = facets_.d(h) / (Float(4) * wo.z);
        const Float specular = select(without_mirrors & mirrors_, Float(0), normals * facets_.g2(o, i));
        const Float cosine = max(wi.z, Float(0));
        Spectrum facets;
        reflectance(cos_d, facets);
        const Float body = diffuse_ * diffuse(wo.z, cosine, cos_d) * cosine;
        const Float fibers = sheen_ * schlick_weight(cos_d) * cosine;
        BsdfEval r;
        for (int k = 0; k < channels; ++k) {
            const Float fibre_color = fma(d_.sheen_tint, tint_.c[k] - Float(1), Float(1));
            r.f_cos.c[k] = fma(facets.c[k], specular, fma(color_.c[k], body, fibre_color * fibers));
        }
        r.pdf = fma(c.reflected, normals * facets_.g1(o), c.diffuse * cosine * Float(inv_pi));
        if (any(coated_ > Float(0))) {
            Float f_cos, pdf;
            coat_.eval(wo, {wi.x, wi.y, cosine}, f_cos, pdf);
            r.f_cos = r.f_cos + Spectrum(coated_ * f_cos);
            r.pdf = fma(c.coat, pdf, r.pdf);
        }
        return r;
    }
    /// Diffuse lobe of a white surface times 1 / pi: rough surfaces are darker or brighter at grazing angles than
    /// Lambert's (Burley 2012); `flatness` blends in an approximation of subsurface scattering (after Hanrahan and
    /// Krueger 1993).
    Float diffuse(Float cos_o, Float cos_i, Float cos_d) const
    {
        const Float o = schlick_weight(cos_o), i = schlick_weight(cos_i), back = Float(2) * roughness_ * cos_d * cos_d;
        const Float base = fma(o, Float(-0.5f), Float(1)) * fma(i, Float(-0.5f), Float(1));
        const Float retro = back * (o + i + o * i * (back - Float(1)));
        const auto flat_at = [&](Float w) { return fma(w, Float(0.5f) * back - Float(1), Float(1)); };
        const Float both = flat_at(o) * flat_at(i), cosines = max(cos_o + cos_i, Float(1e-6f));
        const Float flat = Float(1.25f) * fma(both, Float(1) / cosines - Float(0.5f), Float(0.5f));
        return fma(d_.flatness, flat - (base + retro), base + retro) * Float(inv_pi);
    }
    /// f_cos and pdf of wi below the surface.
    BsdfEval passed(const Chances& c, const Vec3& wo, const Vec3& wi, Mask without_mirrors) const
    {
        const Vec3 o = axes_.to_facets(wo);
        Vec3 i = axes_.to_facets(wi);
        i.z = select(thin_, abs(i.z), i.z);
        Vec3 h = select(thin_, o + i, fma(i, eta_, o));
        h = normalize(h + Vec3{Float(0), Float(0), Float(1e-20f)});
        h = flip_sign(h, h.z);
        const Float oh = dot(o, h), ih = dot(i, h);
        // Facets seen from behind scatter nothing.
        const Mask valid = (refracted_ > Float(0)) & (oh > Float(0)) & equal(ih > Float(0), thin_);
        Float cos_t;
        const Float f = fresnel_dielectric(clamp(oh, Float(0), Float(1)), eta_, cos_t);
        const Float denominator = ih + oh / eta_;
        // Jacobian from normals to directions (Walter et al. 2007). Radiance scales by 1 / eta^2 on refraction.
        const Float refracting = abs(ih) * oh / max(denominator * denominator, Float(1e-20f));
        const Float jacobian = select(thin_, Float(0.25f), refracting);
        const Float spread = select(thin_, Float(1), Float(1) / (eta_ * eta_));
        const Float normals = of_facets([&](const FacetsOf& g) { return g.d(h); }) / wo.z * jacobian;
        const Float shadowing = of_facets([&](const FacetsOf& g) { return g.g2(o, i); });
        const Float sampled = of_facets([&](const FacetsOf& g) { return g.g1(o); });
        const Float straight =
            select(valid & !(without_mirrors & mirrors_), normals * shadowing * (Float(1) - f) * spread, Float(0));
        const Float cosine = max(-wi.z, Float(0)) * Float(inv_pi);
        BsdfEval r;
        for (int k = 0; k < channels; ++k)
            r.f_cos.c[k] = fma(through_.c[k], straight, color_.c[k] * (diffuse_transmission_ * cosine));
        r.pdf = fma(c.refracted, select(valid, normals * sampled, Float(0)), c.beyond * cosine);
        return r;
    }
    /// Returns f of the facets that transmit, which have a roughness of their own on thin surfaces.
    template <class F>
    Float of_facets(F f) const
    {
        const Float value = f(facets_);
        return any(thin_) ? select(thin_, f(thin_facets_), value) : value;
    }

    DisneyPoint d_;
    Spectrum color_, tint_, through_;  ///< tint: base color of luminance 1; through: color of transmitted light
    ChannelWeights weights_;
    Float roughness_, metallic_, eta_;
    Mask thin_, inside_, mirrors_;
    Gtr1Coat coat_;
    FacetAxes axes_;
    FacetsOf facets_, thin_facets_;
    /// Strengths of the lobes: specular reflection, refraction, diffuse reflection, diffuse transmission, sheen, coat.
    Float reflected_, refracted_, diffuse_, diffuse_transmission_, sheen_, coated_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
