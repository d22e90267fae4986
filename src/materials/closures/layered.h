// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/diffuse.h"
#include "materials/closures/glass.h"
#include "materials/lobes/channel_weights.h"
#include "materials/lobes/coat.h"
#include "materials/lobes/lobe_choice.h"
#include "materials/lobes/sheen.h"
#include "materials/lobes/thin_film.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Layered BSDF in the manner of OpenPBR (Andersson et al. 2024), with the parameters of glTF's extensions: sheen over
/// coat over a base that mixes a metal and a dielectric by `metallic`. Below its specular boundary the dielectric
/// reflects diffusely, transmits diffusely, refracts (Walter et al. 2007), or passes light diffusely into a subsurface
/// medium and out again, with weights that add up to 1. Boundary and metal have the same anisotropic GGX microfacets,
/// and their reflectance is that of a thin film where there is one.
///
/// Each layer is attenuated by one minus the directional albedo of the layers above, by tables, for wo. The albedo
/// therefore never exceeds 1, but the BSDF is not reciprocal.
///
/// passes  whether any lobe transmits; only then is the code of transmission compiled
template <bool passes>
class LayeredBsdf
    : public ClosureOf<passes ? ClosureKind::layered_transmitting : ClosureKind::layered, LayeredMaterialPoint> {
public:
    static constexpr bool transmits = passes;
    static constexpr bool is_guided = !passes;

    explicit LayeredBsdf(const LayeredMaterialPoint& m)
        : l_(m.layers), color_(m.base_color), metallic_(m.metallic), thin_(m.thin)
    {
        const Float alpha = m.roughness * m.roughness;
        Float alpha_x = alpha;
        mean_roughness_ = sampled_roughness(m);
        if (l_.has(LayersRecord::anisotropic)) {
            const Float square = l_.anisotropy * l_.anisotropy;
            alpha_x = select(l_.two_roughnesses, square, fma(Float(1) - alpha, square, alpha));
            // Lanes must not depend on each other: isotropic lanes get the same result with or without anisotropic
            // ones.
            const Mask drawn_out = (l_.anisotropy > Float(0)) | l_.two_roughnesses;
            const Float mean =
                sqrt(sqrt(max(alpha * alpha_x, Float(0)))) * select(m.beckmann, Float(sqrt_ggx_of_beckmann), Float(1));
            mean_roughness_ = select(drawn_out, mean, mean_roughness_);
            axes_ = FacetAxes(select(drawn_out, l_.tangent, Vec3(Float(0), Float(0), Float(0))));
        }
        const Float scale = select(m.beckmann, Float(ggx_of_beckmann), Float(1));
        ggx_ = {{max(alpha_x * scale, Float(2 * min_alpha)), max(alpha * scale, Float(2 * min_alpha))},
                m.beckmann,
                m.separable};
        mirrors_ = (alpha < Float(min_alpha)) & (alpha_x < Float(min_alpha));
        // With equal indices on both sides the half vector of refraction is undefined.
        const Float ior = select(abs(m.ior - Float(1)) < Float(5e-4f), Float(1 + 5e-4f), m.ior);
        const Float root = (ior - Float(1)) / (ior + Float(1));
        plain_f0_ = root * root;
        for (int i = 0; i < channels; ++i) f0_.c[i] = min(plain_f0_ * l_.specular_color.c[i], Float(1)) * l_.specular;
        weights_ = ChannelWeights(color_);
        if constexpr (passes) {
            eta_ = select(m.entering | m.thin, ior, Float(1) / ior);
            refracts_ = l_.transmission > Float(0);
            solid_ = refracts_ & !m.thin;
            inside_ = solid_ & !m.entering;
            if (l_.has(LayersRecord::with_subsurface)) l_.subsurface = select(m.entering, l_.subsurface, Float(0));
            // Transmission weights apply to light that enters. Light inside meets a boundary that transmits fully.
            l_.transmission = select(inside_, Float(1), l_.transmission);
            diffuse_reflection_weight_ =
                select(l_.diffuse_transmission_added, Float(1), Float(1) - l_.diffuse_transmission);
            subsurface_weight_ = (Float(1) - l_.transmission) * l_.subsurface;
            diffuse_weight_ = (Float(1) - l_.transmission) * (Float(1) - l_.subsurface);
            for (int i = 0; i < channels; ++i) {
                const Float c = l_.transmission_color.c[i];
                tint_.c[i] = select(solid_, sqrt(max(c, Float(0))), c);
            }
            weights_ = ChannelWeights(color_ * (Float(1) - l_.transmission) + tint_ * l_.transmission);
        }
    }
    Float guided_weight() const
    {
        return fma(metallic_, min(Float(2) * mean_roughness_, Float(1)) - Float(1), Float(1));
    }
    BsdfEval eval(Vec3 wo, Vec3 wi, Mask without_mirrors = Mask(false)) const
    {
        return eval(make_view(wo), wo, wi, without_mirrors);
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float u1) const
    {
        const View v = make_view(wo);
        LobeChoice choice(u.x);
        Mask coated(false), fuzzy(false), diffusely(false), below(false);
        const Mask at_boundary = choice.take(v.p_specular + v.p_refracted);
        if (l_.has(LayersRecord::with_coat)) coated = choice.take(v.p_coat);
        if (l_.has(LayersRecord::with_sheen)) fuzzy = choice.take(v.p_sheen);
        if constexpr (passes) {
            diffusely = choice.take(v.p_diffuse_transmission);
            if (l_.has(LayersRecord::with_subsurface)) below = choice.take(v.p_subsurface);
        }
        choice.take_rest(v.p_diffuse);
        u.x = choice.stretched();

        Vec3 wi = sample_cosine_hemisphere(u);
        Mask refracted(false), goes_beyond(false), total(false);
        const Vec3 h = turned(ggx_.sample(turned(wo, 1), u), -1);
        Mask reflected = at_boundary;
        if constexpr (passes) {
            if (any(refracts_)) {
                const Float o = clamp(dot(wo, h), Float(0), Float(1));
                reflected = at_boundary & (u1 < reflected_chance(o));
            }
        }
        wi = select(reflected, reflect(wo, h), wi);
        if (any(coated)) wi = select(coated, CoatLobe(l_).sample(wo, u), wi);
        if (any(fuzzy)) wi = select(fuzzy, SheenLobe::sample(u), wi);
        if constexpr (passes) {
            const Mask through = at_boundary & !reflected;
            if (any(through)) {
                const Float o = clamp(dot(wo, h), Float(0), Float(1));
                Float cos_t;
                fresnel_dielectric(o, eta_, cos_t);
                const Vec3 mirrored = reflect(wo, h);
                const Vec3 beyond =
                    select(thin_, Vec3{mirrored.x, mirrored.y, -mirrored.z}, normalize(refract(wo, h, o, cos_t, eta_)));
                wi = select(through, beyond, wi);
                refracted = through & solid_;
                total = refracted & !(cos_t > Float(0));
                goes_beyond = through;
            }
            wi.z = select(diffusely | below, -wi.z, wi.z);
            goes_beyond |= diffusely;
        }
        const BsdfEval e = eval(v, wo, wi, Mask(false));
        // Directions on the wrong side and total internal reflection get weight 0: the density there belongs to other
        // lobes.
        const Mask kept = (e.pdf > Float(0)) & equal(wi.z < Float(0), goes_beyond) & !total;
        const Float inverse = select(kept, Float(1) / max(e.pdf, Float(1e-30f)), Float(0));
        BsdfSample s{wi, e.f_cos * inverse, e.pdf, Mask(false), passes ? select(refracted, eta_, Float(1)) : Float(1)};
        if constexpr (passes) {
            if (any(below)) {
                s.weight =
                    select(below, v.coat_transmittance * (entering(v) / max(v.p_subsurface, Float(1e-30f))), s.weight);
                s.is_delta = s.enters_subsurface = below;
            }
        }
        return s;
    }

private:
    /// Quantities that depend on wo only.
    struct View {
        Float sheen_transmittance;    ///< transmittance of the sheen to all layers below it
        Spectrum coat_transmittance;  ///< transmittance of the coat for light that enters and leaves
        Float more;  ///< compensation of opaque facets: reflectance f at normal incidence is scaled by 1 + f * more
        Float refracting;  ///< fraction of the boundary's light that is refracted or reflected rather than scattered
                           ///< below it
        Float refracted_gain;          ///< compensation of a refracting boundary, on both sides
        Float boundary_transmittance;  ///< transmittance of the dielectric's boundary to the diffuse lobes
        /// Selection probabilities of the lobes; diffuse reflection has the remaining probability. p_specular and
        /// p_refracted are used as a sum: the sampled facet decides between them, see reflected_chance().
        Float p_specular, p_coat, p_sheen, p_refracted, p_diffuse_transmission, p_subsurface, p_diffuse;
    };

    /// Light that enters the subsurface medium, without the coat's color.
    Float entering(const View& v) const
    {
        return (Float(1) - metallic_) * v.sheen_transmittance * v.boundary_transmittance * subsurface_weight_;
    }

    /// Rotates between the shading frame (way > 0: from it) and the frame of the facets.
    Vec3 turned(const Vec3& w, int way) const
    {
        if (!l_.has(LayersRecord::anisotropic)) return w;
        return way > 0 ? axes_.to_facets(w) : axes_.from_facets(w);
    }
    /// Weight of the reflectance at grazing incidence against that at normal incidence, 0 to 1.
    Float grazing(Float cosine) const
    {
        Float w = schlick_weight(cosine);
        if constexpr (passes) {
            // Where light may be refracted the exact Fresnel equations are needed: Schlick's has no total internal
            // reflection.
            Float cos_t;
            const Float exact = fresnel_dielectric(clamp(cosine, Float(0), Float(1)), eta_, cos_t);
            const Float by_law = (exact - plain_f0_) / max(Float(1) - plain_f0_, Float(1e-4f));
            w = select(refracts_, clamp(by_law, Float(0), Float(1)), w);
        }
        return w;
    }
    /// Reflectance of microfacets: of the dielectric's boundary and of the metal.
    void reflectance(Float cosine, Spectrum& dielectric, Spectrum& metal) const
    {
        const Float w = grazing(cosine), schlick = schlick_weight(cosine);
        // The artistic specular weight applies to the outside only; inside, total internal reflection stays complete.
        const Float most = passes ? select(inside_, Float(1), l_.specular) : l_.specular;
        // Schlick's reflectance with a color at 82 degrees: Hoffman 2019, "Fresnel Equations Considered Harmful". The
        // cosine there is 1/7, where the polynomial cos (1 - cos)^6 equals (1/7) (6/7)^6.
        constexpr float c82 = 1.0f / 7,
                        p82 = c82 * (6.0f / 7) * (6.0f / 7) * (6.0f / 7) * (6.0f / 7) * (6.0f / 7) * (6.0f / 7);
        constexpr float w82 = (6.0f / 7) * (6.0f / 7) * (6.0f / 7) * (6.0f / 7) * (6.0f / 7);
        const Float side = max(cosine, Float(0)) * schlick * max(Float(1) - cosine, Float(0)) * Float(1 / p82);
        for (int i = 0; i < channels; ++i) {
            const Float c = color_.c[i], at82 = fma(Float(1) - c, Float(w82), c);
            dielectric.c[i] = fma(most - f0_.c[i], w, f0_.c[i]);
            metal.c[i] = clamp(fma(-(side * at82), Float(1) - l_.edge_color.c[i], fma(Float(1) - c, schlick, c)),
                               Float(0), Float(1));
        }
        if (l_.has(LayersRecord::with_conductor))
            for (int i = 0; i < channels; ++i) {
                const Float k = l_.conductor_k.c[i],
                            exact = fresnel_conductor(clamp(cosine, Float(0), Float(1)), l_.conductor_eta.c[i], k);
                metal.c[i] = select(k > Float(0), exact, metal.c[i]);
            }
        if (l_.has(LayersRecord::with_thin_film)) {
            Spectrum f0;
            for (int i = 0; i < channels; ++i) f0.c[i] = fma(metallic_, color_.c[i] - f0_.c[i], f0_.c[i]);
            const Spectrum by_film =
                thin_film_reflectance(clamp(cosine, Float(0), Float(1)), f0, l_.thin_film_thickness, l_.thin_film_ior);
            const Float share = film();
            for (int i = 0; i < channels; ++i) {
                dielectric.c[i] = fma(share, by_film.c[i] - dielectric.c[i], dielectric.c[i]);
                metal.c[i] = fma(share, by_film.c[i] - metal.c[i], metal.c[i]);
            }
        }
    }
    /// Probability that a path at a refracting facet is reflected, in proportion to both contributions, so that weights
    /// vary little. It is 1 where nothing is refracted.
    Float reflected_chance(const Spectrum& dielectric, const Spectrum& metal) const
    {
        const Float boundary = weights_.norm(dielectric);
        const Float reflected = fma(metallic_, weights_.norm(metal) - boundary, boundary);
        const Float refracted = (Float(1) - metallic_) * l_.transmission * weights_.norm(tint_) *
                                max(Float(1) - min_component(dielectric), Float(0));
        const Float all = reflected + refracted;
        return select(refracts_ & (all > Float(0)), reflected / max(all, Float(1e-20f)), Float(1));
    }
    Float reflected_chance(Float cosine) const
    {
        Spectrum dielectric, metal;
        reflectance(cosine, dielectric, metal);
        return reflected_chance(dielectric, metal);
    }
    /// Albedos and selection probabilities of all lobes for wo.
    View make_view(Vec3 wo) const
    {
        View v;
        const Float e = ggx_albedo(wo.z, mean_roughness_), w = albedo_lookup(ggx_schlick_table, wo.z, mean_roughness_);
        v.more = l_.compensation * (Float(1) - e) / e;
        v.refracting = Float(0), v.refracted_gain = Float(1);
        if constexpr (passes) {
            if (any(refracts_)) {
                const Float all = select(thin_, e, dielectric_albedo(wo.z, mean_roughness_, eta_));
                v.refracting = select(refracts_, l_.transmission, Float(0));
                v.refracted_gain = fma(l_.compensation, Float(1) / all - Float(1), Float(1));
            }
        }
        Spectrum dielectric, metal;
        reflectance(wo.z, dielectric, metal);
        v.boundary_transmittance = Float(1) - clamp(boundary_albedo(v, wo.z, e, w, dielectric), Float(0), Float(1));

        Float coat_albedo(0), sheen_albedo(0);
        v.sheen_transmittance = Float(1);
        v.coat_transmittance = Spectrum(Float(1));
        if (l_.has(LayersRecord::with_coat)) {
            coat_albedo = outer(l_.coat) * CoatLobe(l_).albedo(wo);
            v.coat_transmittance = under_coat(coat_albedo);
        }
        if (l_.has(LayersRecord::with_sheen)) {
            const Float albedo = SheenLobe(l_.sheen_roughness).albedo(wo);
            sheen_albedo = outer(weights_.norm(l_.sheen_color)) * albedo;
            v.sheen_transmittance = Float(1) - outer(max_component(l_.sheen_color)) * albedo;
        }
        choose(v, coat_albedo, sheen_albedo, weights_.norm(dielectric), weights_.norm(metal));
        if constexpr (passes) {
            if (l_.has(LayersRecord::with_subsurface)) {
                const auto only_out = [&](Float& p, float out) { p = select(l_.in_subsurface, Float(out), p); };
                only_out(v.p_specular, 0), only_out(v.p_coat, 0), only_out(v.p_sheen, 0), only_out(v.p_refracted, 0);
                only_out(v.p_subsurface, 0), only_out(v.p_diffuse, 0), only_out(v.p_diffuse_transmission, 1);
            }
        }
        return v;
    }
    /// Directional albedo of the dielectric's boundary. e, w: values of the GGX and Schlick tables; dielectric:
    /// reflectance of the boundary at the cosine.
    Float boundary_albedo(const View& v, Float cosine, Float e, Float w, const Spectrum& dielectric) const
    {
        const Float f0 = max_component(f0_);
        // The tables hold Schlick's approximation; refracting lanes correct it by the exact equations.
        if constexpr (passes)
            w = select(refracts_, clamp(fma(grazing(cosine) - schlick_weight(cosine), e, w), Float(0), e), w);
        Float albedo = fma(f0, e - w, l_.specular * w);
        if (l_.has(LayersRecord::with_thin_film))
            albedo = fma(film(), fma(max_component(dielectric), e, -albedo), albedo);
        return albedo * boundary_gain(v, f0);
    }
    /// Compensation factor of the dielectric's reflection for multiple scattering; f0: reflectance at normal incidence.
    /// Most multiply scattered light ends up below the boundary: in the diffuse lobe, which gets what is not reflected,
    /// or refracted.
    Float boundary_gain(const View& v, Float f0) const
    {
        const Float opaque = fma(f0, v.more, Float(1));
        if constexpr (!passes) return opaque;
        return fma(v.refracting, v.refracted_gain - opaque, opaque);
    }
    /// Sets selection probabilities in proportion to the lobes' albedos, whose channels are weighted (ChannelWeights).
    /// The specular boundary has a minimum, because its lobe is narrow and may reflect bright light.
    void choose(View& v, Float coat, Float sheen, Float dielectric, Float metal) const
    {
        const Float base = v.sheen_transmittance * weights_.norm(v.coat_transmittance),
                    body = base * (Float(1) - metallic_);
        Float specular = base * fma(metallic_, metal - dielectric, dielectric);
        Float diffuse = body * v.boundary_transmittance * weights_.norm(color_), beyond(0), refracted(0), below(0);
        if constexpr (passes) {
            diffuse = diffuse * diffuse_weight_;
            beyond = body * v.boundary_transmittance * diffuse_weight_ * l_.diffuse_transmission *
                     weights_.norm(l_.diffuse_transmission_color);
            diffuse = diffuse * diffuse_reflection_weight_;
            refracted = body * l_.transmission * weights_.norm(tint_) * max(Float(1) - dielectric, Float(0.05f));
            below = body * v.boundary_transmittance * subsurface_weight_;
        }
        coat = v.sheen_transmittance * coat;
        const Float others = diffuse + beyond + refracted + coat + sheen + below;
        specular = select(specular > Float(0), max(specular, Float(0.1f) * others), Float(0));
        const Float total = specular + others, scale = Float(1) / max(total, Float(1e-20f));
        v.p_specular = select(total > Float(0), specular * scale, Float(0));
        v.p_coat = coat * scale, v.p_sheen = sheen * scale, v.p_refracted = refracted * scale;
        v.p_diffuse_transmission = beyond * scale, v.p_subsurface = below * scale;
        v.p_diffuse = max(
            Float(1) - v.p_specular - v.p_coat - v.p_sheen - v.p_refracted - v.p_diffuse_transmission - v.p_subsurface,
            Float(0));
    }
    /// Transmittance of the coat for light that enters and leaves, per channel. Interreflection between base and coat
    /// darkens the base: OpenPBR's coat darkening. A diffuse base loses more, since much of its light meets the coat at
    /// angles of total internal reflection.
    Spectrum under_coat(Float coat_albedo) const
    {
        Spectrum left;
        const Float coat = outer(l_.coat), darkening = coat * l_.coat_darkening;
        const Float scattered = fma(metallic_, mean_roughness_ - Float(1), Float(1));
        const Float inner = fma(scattered, l_.coat_inner - l_.coat_f0, l_.coat_f0);
        for (int i = 0; i < channels; ++i) {
            const Float tint = fma(coat, l_.coat_color.c[i] - Float(1), Float(1));
            const Float back = (Float(1) - inner) / fma(-inner, color_.c[i], Float(1));
            left.c[i] = (Float(1) - coat_albedo) * tint * fma(darkening, back - Float(1), Float(1));
        }
        return left;
    }
    /// Transmittance of the sheen for light from wi to wo.
    Float under_sheen(const View& v, const Vec3& wi) const
    {
        if (!l_.has(LayersRecord::sheen_reciprocal)) return v.sheen_transmittance;
        const Float albedo = SheenLobe(l_.sheen_roughness).albedo({wi.x, wi.y, abs(wi.z)});
        const Float left = Float(1) - outer(max_component(l_.sheen_color)) * albedo;
        return select(l_.sheen_reciprocal, min(v.sheen_transmittance, left), v.sheen_transmittance);
    }
    /// Fraction of the surface with a thin film. Films below 30 nm fade out, because the Schlick terms of
    /// thin_film_reflectance don't converge to the bare base.
    Float film() const
    {
        const Float t = clamp(l_.thin_film_thickness * Float(1.0f / 30), Float(0), Float(1));
        return outer(l_.thin_film * t * t * fma(t, Float(-2), Float(3)));
    }
    /// Sheen, film and coat exist on the outside of solids only.
    Float outer(Float strength) const { return passes ? select(inside_, Float(0), strength) : strength; }

    BsdfEval eval(const View& v, Vec3 wo, Vec3 wi, Mask without_mirrors) const
    {
        const Mask above = wi.z > Float(0);
        BsdfEval r = reflected(v, wo, wi, without_mirrors);
        if constexpr (passes) {
            const BsdfEval beyond = passed(v, wo, wi, without_mirrors);
            r.f_cos = select(above, r.f_cos, beyond.f_cos);
            r.pdf = select(above, r.pdf, beyond.pdf);
            if (l_.has(LayersRecord::with_subsurface)) {
                // Light that comes from inside leaves with a cosine distribution.
                const Float out = max(-wi.z, Float(0)) * Float(inv_pi);
                r.f_cos = select(l_.in_subsurface, Spectrum(out), r.f_cos);
                r.pdf = select(l_.in_subsurface, out, r.pdf);
            }
        } else {
            r.f_cos = select(above, r.f_cos, Spectrum(Float(0)));
            r.pdf = select(above, r.pdf, Float(0));
        }
        return r;
    }
    /// f_cos and pdf of wi above the surface.
    BsdfEval reflected(const View& v, const Vec3& wo, const Vec3& wi, Mask without_mirrors) const
    {
        const Vec3 o = turned(wo, 1), i = turned(wi, 1);
        const Vec3 h = normalize(o + i + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Float normals = ggx_.d(h), d = normals / (Float(4) * wo.z);
        const Float facets = ggx_.value(h, normals) / (Float(4) * wo.z) * ggx_.g2(o, i);
        const Float specular = select(without_mirrors & mirrors_, Float(0), facets);
        const Float cosine = max(wi.z, Float(0)) * Float(inv_pi);
        Spectrum dielectric, metal;
        reflectance(max(dot(o, h), Float(0)), dielectric, metal);
        Spectrum body = color_;
        if (l_.has(LayersRecord::rough_diffuse)) {
            RoughPoint rough;
            rough.base_color = color_;
            rough.roughness = l_.diffuse_roughness;
            body = DiffuseBsdf(rough).eval(wo, wi).f_cos * select(cosine > Float(0), Float(1) / cosine, Float(0));
            body = select(l_.diffuse_roughness > Float(0), body, color_);
        }
        const Float sheen_transmittance = under_sheen(v, wi);
        Float share = v.boundary_transmittance;
        if constexpr (passes) share = share * diffuse_weight_ * diffuse_reflection_weight_;
        const Float lambert = share * cosine;
        BsdfEval r;
        for (int k = 0; k < channels; ++k) {
            const Float white = fma(body.c[k], lambert, dielectric.c[k] * boundary_gain(v, f0_.c[k]) * specular);
            const Float shiny = metal.c[k] * fma(color_.c[k], v.more, Float(1)) * specular;
            r.f_cos.c[k] = fma(metallic_, shiny - white, white) * v.coat_transmittance.c[k] * sheen_transmittance;
        }
        Float p_specular = v.p_specular;
        if constexpr (passes) p_specular = (p_specular + v.p_refracted) * reflected_chance(dielectric, metal);
        r.pdf = fma(p_specular, d * ggx_.g1(o), v.p_diffuse * cosine);
        if (l_.has(LayersRecord::with_coat)) {
            Float f_cos, pdf;
            CoatLobe(l_).eval(wo, wi, f_cos, pdf);
            f_cos = f_cos * outer(l_.coat) * sheen_transmittance;
            f_cos = select(without_mirrors & is_mirror(l_.coat_roughness), Float(0), f_cos);
            r.f_cos = r.f_cos + Spectrum(f_cos);
            r.pdf = fma(v.p_coat, pdf, r.pdf);
        }
        if (l_.has(LayersRecord::with_sheen)) {
            const Float f_cos = outer(SheenLobe(l_.sheen_roughness).eval(wo, wi));
            r.f_cos = fma(l_.sheen_color, f_cos, r.f_cos);
            r.pdf = fma(v.p_sheen, Float(SheenLobe::pdf()), r.pdf);
        }
        return r;
    }
    /// f_cos and pdf of wi below the surface.
    BsdfEval passed(const View& v, const Vec3& wo, const Vec3& wi, Mask without_mirrors) const
    {
        const Vec3 o = turned(wo, 1);
        Vec3 i = turned(wi, 1);
        i.z = select(thin_, abs(i.z), i.z);
        Vec3 h = select(thin_, o + i, fma(i, eta_, o));
        h = normalize(h + Vec3{Float(0), Float(0), Float(1e-20f)});
        h = flip_sign(h, h.z);
        const Float oh = dot(o, h), ih = dot(i, h);
        // Facets seen from behind scatter nothing.
        const Mask valid = refracts_ & (oh > Float(0)) & equal(ih > Float(0), thin_);
        Spectrum dielectric, metal;
        reflectance(clamp(oh, Float(0), Float(1)), dielectric, metal);
        const Float normals = ggx_.d(h), d = normals / wo.z, denominator = ih + oh / eta_;
        const Float jacobian = abs(ih) * oh / max(denominator * denominator, Float(1e-20f));
        const Float gain = v.refracted_gain * select(thin_, Float(0.25f), jacobian / (eta_ * eta_));
        const Float f = select(valid & !(without_mirrors & mirrors_),
                               ggx_.value(h, normals) / wo.z * ggx_.g2(o, i) * gain * l_.transmission, Float(0));
        const Float pdf = select(valid, d * ggx_.g1(o) * select(thin_, Float(0.25f), jacobian), Float(0));
        const Float cosine = max(-wi.z, Float(0)) * Float(inv_pi);
        const Float diffuse = v.boundary_transmittance * diffuse_weight_ * l_.diffuse_transmission * cosine;
        const Float body = (Float(1) - metallic_) * under_sheen(v, wi);
        BsdfEval r;
        for (int k = 0; k < channels; ++k) {
            const Float straight = (Float(1) - dielectric.c[k]) * tint_.c[k] * f;
            r.f_cos.c[k] =
                fma(l_.diffuse_transmission_color.c[k], diffuse, straight) * body * v.coat_transmittance.c[k];
        }
        const Float p_refracted = (v.p_specular + v.p_refracted) * (Float(1) - reflected_chance(dielectric, metal));
        r.pdf = fma(p_refracted, pdf, v.p_diffuse_transmission * cosine);
        return r;
    }

    LayersPoint l_;
    Spectrum color_, f0_;
    ChannelWeights weights_;
    Float metallic_;
    Mask thin_;
    Float plain_f0_, mean_roughness_;
    FacetAxes axes_;
    Facets<AnisotropicGgx> ggx_;
    Mask mirrors_;
    // Used only by closures that transmit:
    Spectrum tint_;
    Float eta_{1}, diffuse_weight_{1}, diffuse_reflection_weight_{1}, subsurface_weight_{0};
    Mask refracts_{false}, solid_{false}, inside_{false};
};

}  // namespace FATHOM_LANES
}  // namespace fathom
