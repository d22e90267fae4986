#pragma once
#include "materials/closures/diffuse.h"
#include "materials/closures/glass.h"
#include "materials/lobes/coat.h"
#include "materials/lobes/sheen.h"
#include "materials/lobes/thin_film.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Layers in the manner of OpenPBR (Andersson et al. 2024), with the parameters of glTF's extensions: sheen over coat
/// over a base, which is a mixture by `metallic` of a metal and of a dielectric. Below the dielectric's specular
/// boundary is what is diffuse, passes diffusely to the other side, is refracted (Walter et al. 2007), or goes
/// diffusely into a solid that scatters it and leaves that as diffusely, in shares. Boundary and metal have the same
/// GGX facets, drawn out along a tangent, and under a thin film both reflect as that says.
///
/// A layer gets what those above leave on the way out: 1 less their directional albedo, by the tables. So no surface
/// gives back more than it gets; swapped directions may differ.
///
/// passes: whether any light gets to the other side; only then is that half of the code made.
template <bool passes>
class LayeredBsdf {
public:
    static constexpr ClosureKind kind = passes ? ClosureKind::layered_transmitting : ClosureKind::layered;
    static constexpr bool transmits = passes;
    static constexpr bool is_glossy = true;
    using Point = LayeredMaterialPoint;
    static constexpr bool is_guided = !passes;
    static constexpr bool is_fiber = false;

    explicit LayeredBsdf(const LayeredMaterialPoint& m)
        : l_(m.layers), color_(m.base_color), metallic_(m.metallic), thin_(m.thin)
    {
        const Float alpha = m.roughness * m.roughness;
        Float alpha_x = alpha;
        mean_roughness_ = sampled_roughness(m);
        if (l_.has(LayersRecord::anisotropic)) {
            const Float square = l_.anisotropy * l_.anisotropy;
            alpha_x = select(l_.two_roughnesses, square, fma(Float(1) - alpha, square, alpha));
            // What other lanes have must not change the bits of one.
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
        // Where both sides have the same index nothing would tell the facet that refracted.
        const Float ior = select(abs(m.ior - Float(1)) < Float(5e-4f), Float(1 + 5e-4f), m.ior);
        const Float root = (ior - Float(1)) / (ior + Float(1));
        plain_f0_ = root * root;
        for (int i = 0; i < channels; ++i) f0_.c[i] = min(plain_f0_ * l_.specular_color.c[i], Float(1)) * l_.specular;
        if constexpr (passes) {
            eta_ = select(m.entering | m.thin, ior, Float(1) / ior);
            refracts_ = l_.transmission > Float(0);
            solid_ = refracts_ & !m.thin;
            within_ = solid_ & !m.entering;
            if (l_.has(LayersRecord::with_subsurface)) l_.subsurface = select(m.entering, l_.subsurface, Float(0));
            // The share counts for light that comes in; what is in there finds no body but that of the outside.
            l_.transmission = select(within_, Float(1), l_.transmission);
            reflected_share_ = select(l_.diffuse_transmission_added, Float(1), Float(1) - l_.diffuse_transmission);
            below_share_ = (Float(1) - l_.transmission) * l_.subsurface;
            diffuse_share_ = (Float(1) - l_.transmission) * (Float(1) - l_.subsurface);
            for (int i = 0; i < channels; ++i) {
                const Float c = l_.transmission_color.c[i];
                tint_.c[i] = select(solid_, sqrt(max(c, Float(0))), c);
            }
        }
    }
    Mask has_non_delta() const { return Mask(true); }
    Float guided_weight() const
    {
        return fma(metallic_, min(Float(2) * mean_roughness_, Float(1)) - Float(1), Float(1));
    }
    BsdfEval eval(Vec3 wo, Vec3 wi, Mask without_mirrors = Mask(false)) const
    {
        return eval(look(wo), wo, wi, without_mirrors);
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float u1) const
    {
        const View v = look(wo);
        Vec3 wi = sample_cosine_hemisphere(u);
        Float left = u1;
        const auto chosen = [&](Float share) {
            const Mask m = (left >= Float(0)) & (left < share);
            left = left - share;
            return m;
        };
        Mask refracted(false), goes_beyond(false), total(false), below(false);
        const Vec3 h = turned(ggx_.sample(turned(wo, 1), u), -1);
        const Float p_boundary = v.p_specular + v.p_refracted;
        const Mask at_boundary = chosen(p_boundary);
        Mask reflected = at_boundary;
        if constexpr (passes) {
            if (any(refracts_)) {
                const Float o = clamp(dot(wo, h), Float(0), Float(1));
                reflected = at_boundary & (u1 < p_boundary * reflected_chance(o));
            }
        }
        wi = select(reflected, reflect(wo, h), wi);
        if (l_.has(LayersRecord::with_coat)) {
            const Mask m = chosen(v.p_coat);
            if (any(m)) wi = select(m, CoatLobe(l_).sample(wo, u), wi);
        }
        if (l_.has(LayersRecord::with_sheen)) wi = select(chosen(v.p_sheen), SheenLobe::sample(u), wi);
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
            const Mask diffusely = chosen(v.p_diffuse_beyond);
            if (l_.has(LayersRecord::with_subsurface)) below = chosen(v.p_below);
            wi.z = select(diffusely | below, -wi.z, wi.z);
            goes_beyond |= diffusely;
        }
        const BsdfEval e = eval(v, wo, wi, Mask(false));
        // What facets send to the wrong side is lost, as is what they reflect totally: the density there is of other
        // lobes.
        const Mask kept = (e.pdf > Float(0)) & equal(wi.z < Float(0), goes_beyond) & !total;
        const Float inverse = select(kept, Float(1) / max(e.pdf, Float(1e-30f)), Float(0));
        BsdfSample s{wi, e.f_cos * inverse, e.pdf, Mask(false), passes ? select(refracted, eta_, Float(1)) : Float(1)};
        if constexpr (passes) {
            if (any(below)) {
                s.weight = select(below, v.coat_left * (entering(v) / max(v.p_below, Float(1e-30f))), s.weight);
                s.is_delta = s.enters_subsurface = below;
            }
        }
        return s;
    }

private:
    /// What depends on the path's direction alone.
    struct View {
        Float sheen_left;    ///< what the sheen leaves to all below it
        Spectrum coat_left;  ///< what the coat leaves
        Float more;  ///< compensation of opaque facets: a reflectance of f at normal incidence is scaled by 1 + f more
        Float refracting;      ///< share of the boundary's light that is refracted or reflected, not diffused below it
        Float refracted_gain;  ///< compensation of a boundary that refracts, for both sides
        Float boundary_left;   ///< what the dielectric's boundary leaves to what is diffuse
        /// Chances of the lobes; what is left goes to the diffuse reflection. Which of specular and refracted it is of
        /// both together, the facet decides: see reflected_chance.
        Float p_specular, p_coat, p_sheen, p_refracted, p_diffuse_beyond, p_below, p_diffuse;
    };

    /// What enters the subsurface, but for the coat's colour.
    Float entering(const View& v) const
    {
        return (Float(1) - metallic_) * v.sheen_left * v.boundary_left * below_share_;
    }

    /// Turns between the frame and that of the facets.
    Vec3 turned(const Vec3& w, int way) const
    {
        if (!l_.has(LayersRecord::anisotropic)) return w;
        return way > 0 ? axes_.to_facets(w) : axes_.from_facets(w);
    }
    /// How far reflectance is from that at normal incidence to that at grazing incidence.
    Float grazing(Float cosine) const
    {
        Float w = schlick_weight(cosine);
        if constexpr (passes) {
            // Light that may pass needs the boundary's own law, which knows total reflection.
            Float cos_t;
            const Float exact = fresnel_dielectric(clamp(cosine, Float(0), Float(1)), eta_, cos_t);
            const Float by_law = (exact - plain_f0_) / max(Float(1) - plain_f0_, Float(1e-4f));
            w = select(refracts_, clamp(by_law, Float(0), Float(1)), w);
        }
        return w;
    }
    /// What facets reflect: by the dielectric's boundary and by the metal.
    void reflectance(Float cosine, Spectrum& dielectric, Spectrum& metal) const
    {
        const Float w = grazing(cosine), schlick = schlick_weight(cosine);
        // Light within a solid knows nothing of what the outside was told to reflect.
        const Float most = passes ? select(within_, Float(1), l_.specular) : l_.specular;
        // Schlick's reflectance with a factor at 82 degrees: Hoffman 2019, "Fresnel Equations Considered Harmful"; its
        // cosine is 1/7, where the polynomial cos (1 - cos)^6 is (1/7) (6/7)^6.
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
    /// Of paths at facets that refract, the share that is reflected: by what each way brings, so that weights are even.
    /// 1 where nothing is refracted.
    Float reflected_chance(const Spectrum& dielectric, const Spectrum& metal) const
    {
        const Float boundary = max_component(dielectric);
        const Float reflected = fma(metallic_, max_component(metal) - boundary, boundary);
        const Float refracted = (Float(1) - metallic_) * l_.transmission * max_component(tint_) *
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
    View look(Vec3 wo) const
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
        v.boundary_left = Float(1) - clamp(boundary_albedo(v, wo.z, e, w, dielectric), Float(0), Float(1));

        Float coat_albedo(0), sheen_albedo(0);
        v.sheen_left = Float(1);
        v.coat_left = Spectrum(Float(1));
        if (l_.has(LayersRecord::with_coat)) {
            coat_albedo = outer(l_.coat) * CoatLobe(l_).albedo(wo);
            v.coat_left = under_coat(coat_albedo);
        }
        if (l_.has(LayersRecord::with_sheen)) {
            sheen_albedo = outer(max_component(l_.sheen_color)) * SheenLobe(l_.sheen_roughness).albedo(wo);
            v.sheen_left = Float(1) - sheen_albedo;
        }
        choose(v, coat_albedo, sheen_albedo, max_component(dielectric), max_component(metal));
        if constexpr (passes) {
            if (l_.has(LayersRecord::with_subsurface)) {
                const auto only_out = [&](Float& p, float out) { p = select(l_.in_subsurface, Float(out), p); };
                only_out(v.p_specular, 0), only_out(v.p_coat, 0), only_out(v.p_sheen, 0), only_out(v.p_refracted, 0);
                only_out(v.p_below, 0), only_out(v.p_diffuse, 0), only_out(v.p_diffuse_beyond, 1);
            }
        }
        return v;
    }
    /// Share of light that the dielectric's boundary reflects. e, w: of the tables; dielectric: its reflectance at the
    /// cosine.
    Float boundary_albedo(const View& v, Float cosine, Float e, Float w, const Spectrum& dielectric) const
    {
        const Float f0 = max_component(f0_);
        // The tables are of Schlick's law.
        if constexpr (passes)
            w = select(refracts_, clamp(fma(grazing(cosine) - schlick_weight(cosine), e, w), Float(0), e), w);
        Float albedo = fma(f0, e - w, l_.specular * w);
        if (l_.has(LayersRecord::with_thin_film))
            albedo = fma(film(), fma(max_component(dielectric), e, -albedo), albedo);
        return albedo * boundary_gain(v, f0);
    }
    /// Compensation of the dielectric's reflection, f0 at normal incidence. What facets scatter more than once mostly
    /// ends up below the boundary: in the diffuse body, which gets what is not reflected, or refracted.
    Float boundary_gain(const View& v, Float f0) const
    {
        const Float opaque = fma(f0, v.more, Float(1));
        if constexpr (!passes) return opaque;
        return fma(v.refracting, v.refracted_gain - opaque, opaque);
    }
    /// Chances in the proportions of the lobes' albedos, of which the boundary's has a least one: it is narrow, and
    /// what is met there may be bright.
    void choose(View& v, Float coat, Float sheen, Float dielectric, Float metal) const
    {
        const Float base = v.sheen_left * max_component(v.coat_left), body = base * (Float(1) - metallic_);
        Float specular = base * fma(metallic_, metal - dielectric, dielectric);
        Float diffuse = body * v.boundary_left * max_component(color_), beyond(0), refracted(0), below(0);
        if constexpr (passes) {
            diffuse = diffuse * diffuse_share_;
            beyond = body * v.boundary_left * diffuse_share_ * l_.diffuse_transmission *
                     max_component(l_.diffuse_transmission_color);
            diffuse = diffuse * reflected_share_;
            refracted = body * l_.transmission * max_component(tint_) * max(Float(1) - dielectric, Float(0.05f));
            below = body * v.boundary_left * below_share_;
        }
        coat = v.sheen_left * coat;
        const Float others = diffuse + beyond + refracted + coat + sheen + below;
        specular = select(specular > Float(0), max(specular, Float(0.1f) * others), Float(0));
        const Float total = specular + others, scale = Float(1) / max(total, Float(1e-20f));
        v.p_specular = select(total > Float(0), specular * scale, Float(0));
        v.p_coat = coat * scale, v.p_sheen = sheen * scale, v.p_refracted = refracted * scale;
        v.p_diffuse_beyond = beyond * scale, v.p_below = below * scale;
        v.p_diffuse = max(
            Float(1) - v.p_specular - v.p_coat - v.p_sheen - v.p_refracted - v.p_diffuse_beyond - v.p_below, Float(0));
    }
    /// What the coat leaves of light that goes in and out through it. What comes up from the base meets the coat from
    /// within, which sends a part of it down again, and so on: OpenPBR's darkening. A base that scatters sends more of
    /// its light at angles that the coat reflects totally.
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
    /// What the sheen leaves of light that goes in from wi and out.
    Float under_sheen(const View& v, const Vec3& wi) const
    {
        if (!l_.has(LayersRecord::sheen_reciprocal)) return v.sheen_left;
        const Float albedo = SheenLobe(l_.sheen_roughness).albedo({wi.x, wi.y, abs(wi.z)});
        const Float left = Float(1) - outer(max_component(l_.sheen_color)) * albedo;
        return select(l_.sheen_reciprocal, min(v.sheen_left, left), v.sheen_left);
    }
    /// Share of the surface that has a film; one of less than 30 nanometres fades away, since Schlick's terms would
    /// not.
    Float film() const
    {
        const Float t = clamp(l_.thin_film_thickness * Float(1.0f / 30), Float(0), Float(1));
        return outer(l_.thin_film * t * t * fma(t, Float(-2), Float(3)));
    }
    /// Sheen, film and coat are on the outside of solids.
    Float outer(Float strength) const { return passes ? select(within_, Float(0), strength) : strength; }

    BsdfEval eval(const View& v, Vec3 wo, Vec3 wi, Mask without_mirrors) const
    {
        const Mask above = wi.z > Float(0);
        BsdfEval r = reflected(v, wo, wi, without_mirrors);
        if constexpr (passes) {
            const BsdfEval beyond = passed(v, wo, wi, without_mirrors);
            r.f_cos = select(above, r.f_cos, beyond.f_cos);
            r.pdf = select(above, r.pdf, beyond.pdf);
            if (l_.has(LayersRecord::with_subsurface)) {
                // From within all gets out, whatever the direction.
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
            MaterialPoint rough;
            rough.base_color = color_;
            rough.roughness = l_.diffuse_roughness;
            body = DiffuseBsdf(rough).eval(wo, wi).f_cos * select(cosine > Float(0), Float(1) / cosine, Float(0));
            body = select(l_.diffuse_roughness > Float(0), body, color_);
        }
        const Float sheen_left = under_sheen(v, wi);
        Float share = v.boundary_left;
        if constexpr (passes) share = share * diffuse_share_ * reflected_share_;
        const Float lambert = share * cosine;
        BsdfEval r;
        for (int k = 0; k < channels; ++k) {
            const Float white = fma(body.c[k], lambert, dielectric.c[k] * boundary_gain(v, f0_.c[k]) * specular);
            const Float shiny = metal.c[k] * fma(color_.c[k], v.more, Float(1)) * specular;
            r.f_cos.c[k] = fma(metallic_, shiny - white, white) * v.coat_left.c[k] * sheen_left;
        }
        Float p_specular = v.p_specular;
        if constexpr (passes) p_specular = (p_specular + v.p_refracted) * reflected_chance(dielectric, metal);
        r.pdf = fma(p_specular, d * ggx_.g1(o), v.p_diffuse * cosine);
        if (l_.has(LayersRecord::with_coat)) {
            Float f_cos, pdf;
            CoatLobe(l_).eval(wo, wi, f_cos, pdf);
            f_cos = f_cos * outer(l_.coat) * sheen_left;
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
        const Float diffuse = v.boundary_left * diffuse_share_ * l_.diffuse_transmission * cosine;
        const Float body = (Float(1) - metallic_) * under_sheen(v, wi);
        BsdfEval r;
        for (int k = 0; k < channels; ++k) {
            const Float straight = (Float(1) - dielectric.c[k]) * tint_.c[k] * f;
            r.f_cos.c[k] = fma(l_.diffuse_transmission_color.c[k], diffuse, straight) * body * v.coat_left.c[k];
        }
        const Float p_refracted = (v.p_specular + v.p_refracted) * (Float(1) - reflected_chance(dielectric, metal));
        r.pdf = fma(p_refracted, pdf, v.p_diffuse_beyond * cosine);
        return r;
    }

    LayersPoint l_;
    Spectrum color_, f0_;
    Float metallic_;
    Mask thin_;
    Float plain_f0_, mean_roughness_;
    FacetAxes axes_;
    Facets<AnisotropicGgx> ggx_;
    Mask mirrors_;
    // Of closures that pass light:
    Spectrum tint_;
    Float eta_{1}, diffuse_share_{1}, reflected_share_{1}, below_share_{0};
    Mask refracts_{false}, solid_{false}, within_{false};
};

}  // namespace FATHOM_LANES
}  // namespace fathom
