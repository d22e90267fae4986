#pragma once
/// What surfaces do with light. Directions are in the frame of the shading normal, unit, pointing away from the
/// surface; wo.z > 0: frames are turned to the side that the path is on.
///
/// A bsdf offers
///     BsdfEval eval(wo, wi)          what part of the light from wi goes to wo, times the cosine, and the density of
///     sampling wi BsdfSample sample(wo, u, u1)   a direction with its weight, f_cos / pdf Mask has_smooth() lanes with
///     anything but delta lobes, for which lights are sampled
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
    Mask thin;      ///< glass: a sheet without thickness
};

inline Vec3 refract(Vec3 wo, Vec3 h, Float cos_o, Float cos_t, Float eta)
{
    return h * (cos_o / eta - cos_t) - wo * (Float(1) / eta);
}

/// Lambert's, or for roughness > 0 the energy-preserving Oren-Nayar of Portsmouth, Kutz and Hill 2024 ("EON"), whose
/// multiply scattered part makes up for what single scattering loses. Sampled by the cosine.
class DiffuseBsdf {
public:
    static constexpr bool transmits = false;

    explicit DiffuseBsdf(const MaterialPoint& m) : color_(m.base_color), r_(m.roughness)
    {
        is_rough_ = any(r_ > Float(0));
    }
    Mask has_smooth() const { return Mask(true); }
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

    /// Share of light that single scattering reflects for albedo 1, by the paper's polynomial fit.
    Float single_albedo(Float cosine) const
    {
        const Float m = Float(1) - cosine;
        Float g = fma(m, Float(0.0714429953f), Float(-0.332181442f));
        g = fma(m, g, Float(0.491881867f));
        g = m * fma(m, g, Float(0.0571085289f));
        return fma(r_, g, Float(1)) / fma(r_, Float(c1), Float(1));
    }
    /// The bsdf times pi.
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

/// A conductor: GGX facets with Schlick's reflectance, scaled so that what facets scatter more than once is not lost
/// (Turquin 2019, "Practical multiple scattering compensation for microfacet models"). Below min_alpha a mirror.
class MetalBsdf {
public:
    static constexpr bool transmits = false;

    explicit MetalBsdf(const MaterialPoint& m)
        : color_(m.base_color), roughness_(m.roughness), ggx_{max(m.roughness * m.roughness, Float(min_alpha))}
    {
        is_mirror_ = m.roughness * m.roughness < Float(min_alpha);
    }
    Mask has_smooth() const { return !is_mirror_; }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Vec3 h = normalize(wo + wi + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Mask valid = (wi.z > Float(0)) & has_smooth();
        const Float d = ggx_.d(h);
        const Float f = select(valid, d * ggx_.g2(wo, wi) / (Float(4) * wo.z), Float(0));
        const Float pdf = select(valid, ggx_.g1(wo) * d / (Float(4) * wo.z), Float(0));
        return {reflectance(wo, dot(wo, h)) * f, pdf};
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float) const
    {
        const Vec3 h = select(is_mirror_, Vec3{Float(0), Float(0), Float(1)}, ggx_.sample(wo, u));
        const Vec3 wi = reflect(wo, h);
        const Float g = select(is_mirror_, Float(1), ggx_.g2(wo, wi) / ggx_.g1(wo));
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
    Ggx ggx_;
    Mask is_mirror_;
};

/// The metal of "Ray Tracing in One Weekend" and of the report: the mirror direction plus fuzz times a random point of
/// the unit ball; what would go below the surface is absorbed.
///
/// The direction has a density in closed form: the share of the ball of radius fuzz around the mirror direction that
/// lies on a ray, weighted by r^2. So lights can be sampled too, and the look is the original's exactly.
class FuzzMetalBsdf {
public:
    static constexpr bool transmits = false;

    explicit FuzzMetalBsdf(const MaterialPoint& m) : color_(m.base_color), fuzz_(clamp(m.fuzz, Float(0), Float(1)))
    {
        is_mirror_ = fuzz_ < Float(1e-3f);
    }
    Mask has_smooth() const { return !is_mirror_; }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Float p = select((wi.z > Float(0)) & has_smooth(), pdf(wo, wi), Float(0));
        return {color_ * p, p};
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float u1) const
    {
        // A point of the unit ball; its distance from the centre is the cube root of a uniform number.
        const Float z = fma(u.x, Float(-2), Float(1));
        const Float s = sqrt(max(fma(-z, z, Float(1)), Float(0)));
        const SinCos phi = sincos_2pi(u.y);
        const Float r = select(is_mirror_, Float(0), fuzz_ * pow(u1, Float(1.0f / 3)));
        const Vec3 mirror{-wo.x, -wo.y, wo.z};
        const Vec3 wi = normalize(fma(Vec3{s * phi.cos, s * phi.sin, z}, r, mirror));
        return {wi, color_ * select(wi.z > Float(0), Float(1), Float(0)), pdf(wo, wi), is_mirror_, Float(1)};
    }

private:
    Float pdf(Vec3 wo, Vec3 wi) const
    {
        const Vec3 mirror{-wo.x, -wo.y, wo.z};
        const Float b = dot(mirror, wi);
        const Vec3 off = mirror - wi * b;
        const Float root2 = fma(fuzz_, fuzz_, -dot(off, off));
        const Float root = sqrt(max(root2, Float(0)));
        const Float far = b + root, near = max(b - root, Float(0));
        const Float f3 = max(fuzz_ * fuzz_ * fuzz_, Float(1e-12f));
        const Float p = (far * far * far - near * near * near) / (Float(4 * pi) * f3);
        return select((root2 > Float(0)) & (far > Float(0)), p, Float(0));
    }

    Spectrum color_;
    Float fuzz_;
    Mask is_mirror_;
};

/// A dielectric boundary, smooth or of GGX facets: Walter et al. 2007, "Microfacet Models for Refraction through Rough
/// Surfaces". Radiance that is refracted is scaled by the square of the indices' ratio, and by the root of the colour:
/// a way in and out of a solid takes the whole of it.
///
/// Or a thin sheet, two boundaries with nothing between. What it lets through goes straight on, times the colour;
/// facets spread that as they spread reflections, on the other side. Of a reflectance r of each boundary, all the ways
/// between them (r, t r t, t r^3 t, ...) make 2 r / (1 + r). Scaled for multiple scattering, as the metal is.
class GlassBsdf {
public:
    static constexpr bool transmits = true;

    explicit GlassBsdf(const MaterialPoint& m)
        : roughness_(m.roughness),
          ggx_{max(m.roughness * m.roughness, Float(min_alpha))},
          color_(m.base_color),
          is_thin_(m.thin)
    {
        eta_ = select(m.entering | is_thin_, m.ior, Float(1) / m.ior);
        is_smooth_ = m.roughness * m.roughness < Float(min_alpha);
        for (Float& c : color_.c) c = select(is_thin_, c, sqrt(max(c, Float(0))));
    }
    Mask has_smooth() const { return !is_smooth_; }
    BsdfEval eval(Vec3 wo, Vec3 wi) const
    {
        const Mask reflects = wi.z > Float(0);
        // Where facets decide as for a reflection, they get one.
        const Mask mirrors = reflects | is_thin_;
        wi.z = select(is_thin_, abs(wi.z), wi.z);
        Vec3 h = select(mirrors, wo + wi, fma(wi, eta_, wo));
        h = normalize(h + Vec3{Float(0), Float(0), Float(1e-20f)});
        h = flip_sign(h, h.z);
        const Float o = dot(wo, h), i = dot(wi, h);
        // Facets seen from behind scatter nothing: wo in front, wi on the side it goes to.
        const Mask valid = has_smooth() & (o > Float(0)) & equal(i > Float(0), mirrors);
        Float cos_t;
        const Float r = reflectance(min(o, Float(1)), cos_t);
        const Float share = select(reflects, r, Float(1) - r);
        const Float d = ggx_.d(h), g = ggx_.g2(wo, wi), visible = ggx_.g1(wo) * d / wo.z;
        const Float denominator = i + o / eta_;
        const Float jacobian = abs(i) / max(denominator * denominator, Float(1e-20f));
        const Float f_mirror = share * d * g / (Float(4) * wo.z);
        const Float f_refract = share * d * g * jacobian * o / (wo.z * eta_ * eta_);
        const Float f = select(valid, select(mirrors, f_mirror, f_refract), Float(0));
        const Float pdf = select(valid, visible * share * select(mirrors, Float(0.25f), jacobian * o), Float(0));
        return {tint(reflects) * (f * gain(wo)), pdf};
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
        const Float g = select(is_smooth_, Float(1), ggx_.g2(wo, wi) / ggx_.g1(wo));
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
        return select(is_thin_, Float(2) * r / (Float(1) + r), r);
    }
    /// What makes up for light that facets of a thin sheet scatter more than once.
    Float gain(Vec3 wo) const
    {
        const Mask rough_sheet = is_thin_ & !is_smooth_;
        if (none(rough_sheet)) return Float(1);
        return select(rough_sheet, Float(1) / ggx_albedo(wo.z, roughness_), Float(1));
    }
    Spectrum tint(Mask reflects) const { return select(reflects, Spectrum(Float(1)), color_); }

    Float roughness_;
    Ggx ggx_;
    Spectrum color_;
    Float eta_;
    Mask is_thin_, is_smooth_;
};

/// The metallic-roughness model of glTF 2.0 (its appendix B): the mixture by `metallic` of a metal and of a dielectric,
/// a diffuse base under a specular layer, both of the same GGX facets. Each is scaled by itself for multiple
/// scattering, which is no linear function of the reflectance, as the metal's; the base gets what the layer's
/// directional albedo leaves (where glTF's own formula takes the half vector's reflectance, and makes energy at grazing
/// angles).
class PrincipledBsdf {
public:
    static constexpr bool transmits = false;

    explicit PrincipledBsdf(const MaterialPoint& m)
        : roughness_(m.roughness),
          ggx_{max(m.roughness * m.roughness, Float(2 * min_alpha))},
          metallic_(m.metallic),
          color_(m.base_color)
    {
        const Float r = (m.ior - Float(1)) / (m.ior + Float(1));
        dielectric_f0_ = r * r;
        const Float most = max_component(color_);
        most_f0_ = fma(metallic_, max(most, dielectric_f0_) - dielectric_f0_, dielectric_f0_);
        most_diffuse_ = most * (Float(1) - metallic_);
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
    Spectrum color_;
};

}  // namespace fathom::inline FATHOM_LANES
