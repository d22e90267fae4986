// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"
#include "materials/closures/facets_or_body.h"
#include "materials/closures/plastic_tables.h"
#include "materials/lobes/channel_weights.h"
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parameters of PlasticBsdf, with textures applied: see PlasticRecord.
struct PlasticPoint : FacetsPoint {
    using Record = PlasticRecord;
    Float ior;
    Float optical_thickness{0}, internal_absorption{0};  ///< properties of the absorbing layer, see PlasticRecord
    Mask nonlinear{true};                 ///< lanes where each internal reflection multiplies by the body's color
    Spectrum reflection_color{Float(1)};  ///< factor of reflections

    void read(const ParameterReader<Record>& r)
    {
        read_facets(r);
        ior = r.get(&Record::ior);
        optical_thickness = r.get(&Record::optical_thickness);
        internal_absorption = r.get(&Record::internal_absorption);
        nonlinear = r.has_flag(Record::nonlinear);
        const Mask tinted = r.has_flag(Record::tinted);
        if (any(tinted))
            reflection_color = r.color(&Record::reflection_color, &Record::reflection_color_texture, tinted);
    }
};

/// A smooth or rough dielectric boundary over a diffuse body. Microfacets reflect by Fresnel's equations (Walter et al.
/// 2007). Light that enters is scattered by the body and partly reflected back at the boundary, repeatedly, until it
/// leaves. The body is diffuse, so the series has a closed form in the boundary's directional transmittance and its
/// mean internal reflectance:
///
///      color / pi * passes(wo) * passes(wi) / (ior^2 (1 - color * inner))
///
/// Rough boundaries take both from tables. With energy compensation, all light that is not reflected in the first event
/// enters; otherwise only light that passes in the first event enters, as in layers simulated by random walks, and the
/// rest is lost.
///
/// A gray layer between boundary and body absorbs along the directions that a smooth boundary refracts to, and absorbs
/// the fraction `internal_absorption` of internally reflected light.
class PlasticBsdf : public ClosureOf<ClosureKind::plastic, PlasticPoint> {
public:
    static constexpr bool is_guided = true;

    explicit PlasticBsdf(const PlasticPoint& m)
        : roughness_(sampled_roughness(m)),
          ggx_({max(sampled_alpha(m), Float(2 * min_alpha))}, m.beckmann, m.separable),
          mirrors_(is_mirror(m.roughness)),
          facets_(select(m.compensated, UInt(compensated),
                         select(m.beckmann, UInt(beckmann), select(m.separable, UInt(separable), UInt(correlated))))),
          tint_(m.reflection_color),
          ior_(clamp(m.ior, Float(1), Float(3))),
          thickness_(m.optical_thickness)
    {
        const UInt row_of_facets = UInt(passing) + (facets_ - UInt(1)) * UInt(2);
        const Mask all_goes_in = facets_ == UInt(compensated);
        const Float lets_in = select(all_goes_in, Float(1), mean_of(row_of_facets)) * (Float(1) - mean_reflected());
        const Float lost = select(all_goes_in, Float(0), mean_of(row_of_facets + UInt(1)));
        const Float out = lets_in / (ior_ * ior_),
                    follows = clamp(Float(1) - out - lost, Float(0), Float(1)) * (Float(1) - m.internal_absorption),
                    inner = select(m.internal_absorption < Float(0), -m.internal_absorption, follows);
        for (int i = 0; i < channels; ++i) {
            const Float color = m.base_color.c[i];
            // Mitsuba's linear model treats internally reflected light as white.
            const Float again = select(m.nonlinear, color, Float(1));
            body_.c[i] = color / (ior_ * ior_ * max(fma(-again, inner, Float(1)), Float(1e-6f)));
        }
        const Spectrum body = body_ * lets_in;
        const ChannelWeights weights(body);
        body_share_ = weights.norm(body) / max(weights.norm(tint_), Float(1e-4f));
    }
    Float guided_weight() const { return Float(1); }
    BsdfEval eval(Vec3 wo, Vec3 wi, Mask without_mirrors = Mask(false)) const
    {
        const Vec3 h = normalize(wo + wi + Vec3{Float(0), Float(0), Float(1e-20f)});
        const Mask valid = wi.z > Float(0);
        const Float d = ggx_.d(h), scale = Float(1) / (Float(4) * wo.z);
        Float beyond;
        const Float f = fresnel_dielectric(clamp(dot(wo, h), Float(0), Float(1)), ior_, beyond);
        const Float boundary =
            select(without_mirrors & mirrors_, Float(0), f * ggx_.value(h, d) * ggx_.g2(wo, wi) * scale);
        const Float passes_out = passes(wo.z), cosine = wi.z * Float(inv_pi);
        const Float body = passes_out * passes(wi.z) * layer_transmittance(wo.z, wi.z) * cosine;
        BsdfEval r;
        for (int i = 0; i < channels; ++i)
            r.f_cos.c[i] = select(valid, fma(body_.c[i], body, tint_.c[i] * boundary), Float(0));
        const Float p = boundary_probability(passes_out);
        r.pdf = select(valid, fma(p, ggx_.g1(wo) * d * scale, (Float(1) - p) * cosine), Float(0));
        return r;
    }
    BsdfSample sample(Vec3 wo, Sample2 u, Float) const
    {
        return reflection_of_facets_or_body(*this, ggx_, boundary_probability(passes(wo.z)), wo, u);
    }

private:
    /// Numbers of the blocks of plastic_share_table.
    enum : std::uint32_t { compensated, correlated, separable, beckmann };
    /// Numbers of the rows of plastic_means_table. From `passing` on, there are two rows for each kind of facets but
    /// the first: transmittance, and loss of internal light.
    enum : std::uint32_t { reflecting, bend, passing };

    Float mean_of(UInt row) const
    {
        const Float y = clamp(roughness_, Float(0), Float(1)) * Float(ggx_albedo_size - 1);
        const Float y0 = min(floor(y), Float(ggx_albedo_size - 2));
        const UInt index = to_uint(y0) + row * UInt(ggx_albedo_size);
        const Float a = gather(plastic_means_table, index), b = gather(plastic_means_table, index + UInt(1));
        return fma(y - y0, b - a, a);
    }
    /// Mean reflectance of the boundary for diffuse light. The table is for index 1.5; other indices interpolate
    /// between the behavior of a smooth boundary and that of normal incidence.
    Float mean_reflected() const
    {
        const Float r = (ior_ - Float(1)) / (ior_ + Float(1)), root = sqrt(r);
        Float smooth(0);
        for (int k = 6; k >= 0; --k) smooth = fma(smooth, root, Float(smooth_mean_polynomial[k]));
        constexpr float smooth_of_table = 0.0917780f, normal_of_table = 0.04f;
        const Float by_smooth = max(smooth * root, Float(0)) * Float(1 / smooth_of_table);
        const Float by_normal = r * r * Float(1 / normal_of_table);
        return mean_of(UInt(reflecting)) * fma(mean_of(UInt(bend)), by_normal - by_smooth, by_smooth);
    }
    /// Fraction of light that passes the boundary from or to a direction, for one scattering event.
    Float passes(Float cosine) const
    {
        constexpr std::uint32_t size = ggx_albedo_size * ggx_albedo_size;
        const Float share = albedo_lookup(plastic_share_table, cosine, roughness_, facets_ * UInt(size));
        Float beyond;
        const Float f = fresnel_dielectric(albedo_lookup(plastic_cosine_table, cosine, roughness_), ior_, beyond);
        return fma(-f, share, select(facets_ == UInt(compensated), Float(1), share));
    }
    /// Transmittance of the absorbing layer on the way in and out.
    Float layer_transmittance(Float cosine_in, Float cosine_out) const
    {
        if (none(thickness_ > Float(0))) return Float(1);
        const Float inverse = Float(1) / (ior_ * ior_);
        const auto way = [&](Float cosine) {
            return inverse_sqrt(max(fma(fma(cosine, cosine, Float(-1)), inverse, Float(1)), Float(1e-6f)));
        };
        return exp(-(thickness_ * (way(cosine_in) + way(cosine_out))));
    }
    /// Probability of sampling the boundary's reflection. passes_out: transmittance of the boundary towards wo.
    Float boundary_probability(Float passes_out) const
    {
        const Float s = Float(1) - passes_out, b = passes_out * body_share_;
        return select(b > Float(0), clamp(s / max(s + b, Float(1e-20f)), Float(0.1f), Float(0.9f)), Float(1));
    }

    Float roughness_;
    Facets<Ggx> ggx_;
    Mask mirrors_;
    UInt facets_;    ///< selects the blocks and rows of the tables
    Spectrum tint_;  ///< color of the boundary's reflection
    Float ior_, thickness_;
    Float body_share_;  ///< albedo of the body relative to that of a boundary that reflects everything
    Spectrum body_;     ///< body's BRDF without the boundary's transmittances and 1 / pi
};

}  // namespace FATHOM_LANES
}  // namespace fathom
