// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The GGX microfacet distribution: Walter et al. 2007, with the height-correlated Smith term (Heitz 2014), and Fresnel
/// equations. Directions are in the frame of the shading normal.
#include "materials/microfacet/dielectric_albedo_table.h"
#include "materials/microfacet/ggx_albedo_table.h"
#include "math/elementary.h"
#include "math/spectrum.h"
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Surfaces of a smaller alpha are treated as mirrors: float can't tell their lobe from a delta distribution.
inline constexpr float min_alpha = 1e-3f;

/// Samples the distribution of normals visible from wo (wo.z > 0): Dupuy and Benyoub 2023, "Sampling Visible GGX
/// Normals with Spherical Caps".
inline Vec3 sample_visible_normal(Vec3 wo, Float alpha_x, Float alpha_y, Sample2 u)
{
    const Vec3 stretched = normalize({wo.x * alpha_x, wo.y * alpha_y, wo.z});
    const Float z = fma(Float(1) - u.y, Float(1) + stretched.z, -stretched.z);
    const Float s = sqrt(clamp(fma(-z, z, Float(1)), Float(0), Float(1)));
    const SinCos phi = sincos_2pi(u.x);
    const Vec3 c{fma(s, phi.cos, stretched.x), fma(s, phi.sin, stretched.y), z + stretched.z};
    return normalize({c.x * alpha_x, c.y * alpha_y, max(c.z, Float(1e-6f))});
}

/// Isotropic GGX distribution. d: density of normals; g1, g2: masking and height-correlated shadowing-masking; lambda:
/// Smith's auxiliary function.
struct Ggx {
    Float alpha;

    Float d(Vec3 h) const
    {
        const Float a2 = alpha * alpha;
        const Float t = fma(h.z * h.z, a2 - Float(1), Float(1));
        // 1 - cos^2 would cancel near the normal; the sine computed from x and y is exact.
        const Float sine2 = fma(h.x, h.x, h.y * h.y);
        const Float e = select(h.z > Float(0.9f), fma(a2, h.z * h.z, sine2), t);
        return a2 * Float(inv_pi) / max(e * e, Float(1e-30f));
    }
    Float lambda(Vec3 w) const
    {
        const Float cos2 = max(w.z * w.z, Float(1e-12f));
        const Float tan2 = max(Float(1) - cos2, Float(0)) / cos2;
        return Float(0.5f) * (sqrt(fma(alpha * alpha, tan2, Float(1))) - Float(1));
    }
    Float g1(Vec3 w) const { return Float(1) / (Float(1) + lambda(w)); }
    Float g2(Vec3 wo, Vec3 wi) const { return Float(1) / (Float(1) + lambda(wo) + lambda(wi)); }

    /// Squared slope of a normal, divided by alpha^2.
    Float slope2(Vec3 h) const { return fma(h.x, h.x, h.y * h.y) / max(alpha * alpha * h.z * h.z, Float(1e-30f)); }
    /// alpha^2 tan^2 of a direction, the argument of Smith's lambda.
    Float stretch2(Vec3 w) const { return alpha * alpha * fma(w.x, w.x, w.y * w.y) / max(w.z * w.z, Float(1e-12f)); }
    Float alpha2() const { return alpha * alpha; }
    Vec3 sample(Vec3 wo, Sample2 u) const { return sample_visible_normal(wo, alpha, alpha, u); }
    /// Solid angle density of the normals that sample returns.
    Float pdf(Vec3 wo, Vec3 h) const { return g1(wo) * max(dot(wo, h), Float(0)) * d(h) / wo.z; }
};

/// Anisotropic GGX distribution, with alpha_x and alpha_y along the axes of the frame; members as in Ggx.
struct AnisotropicGgx {
    Float alpha_x, alpha_y;

    Float d(Vec3 h) const
    {
        const Float x = h.x / alpha_x, y = h.y / alpha_y;
        const Float e = fma(x, x, fma(y, y, h.z * h.z));
        return Float(inv_pi) / max(alpha_x * alpha_y * e * e, Float(1e-30f));
    }
    Float lambda(Vec3 w) const
    {
        const Float x = w.x * alpha_x, y = w.y * alpha_y;
        const Float tan2 = fma(x, x, y * y) / max(w.z * w.z, Float(1e-12f));
        return Float(0.5f) * (sqrt(Float(1) + tan2) - Float(1));
    }
    Float g1(Vec3 w) const { return Float(1) / (Float(1) + lambda(w)); }
    Float g2(Vec3 wo, Vec3 wi) const { return Float(1) / (Float(1) + lambda(wo) + lambda(wi)); }
    Float slope2(Vec3 h) const
    {
        const Float x = h.x / alpha_x, y = h.y / alpha_y;
        return fma(x, x, y * y) / max(h.z * h.z, Float(1e-30f));
    }
    Float stretch2(Vec3 w) const
    {
        const Float x = w.x * alpha_x, y = w.y * alpha_y;
        return fma(x, x, y * y) / max(w.z * w.z, Float(1e-12f));
    }
    Float alpha2() const { return alpha_x * alpha_y; }
    Vec3 sample(Vec3 wo, Sample2 u) const { return sample_visible_normal(wo, alpha_x, alpha_y, u); }
};

/// Rotation about the shading normal that takes a tangent to the x axis: the axes of anisotropic microfacets.
struct FacetAxes {
    Float cosine{1}, sine{0};

    FacetAxes() = default;
    /// tangent: in the frame of the shading normal; a tangent of length near 0 gives the identity
    explicit FacetAxes(const Vec3& tangent)
    {
        const Float sine2 = fma(tangent.x, tangent.x, tangent.y * tangent.y);
        const Mask known = sine2 > Float(1e-12f);
        const Float inverse = inverse_sqrt(max(sine2, Float(1e-12f)));
        cosine = select(known, tangent.x * inverse, Float(1));
        sine = select(known, tangent.y * inverse, Float(0));
    }
    Vec3 to_facets(const Vec3& w) const { return turned(w, sine); }
    Vec3 from_facets(const Vec3& w) const { return turned(w, -sine); }

private:
    Vec3 turned(const Vec3& w, Float s) const { return {fma(w.x, cosine, w.y * s), fma(w.y, cosine, -(w.x * s)), w.z}; }
};

/// Alpha of the GGX distribution that best matches a Beckmann distribution, divided by Beckmann's alpha.
inline constexpr float ggx_of_beckmann = 0.7f, sqrt_ggx_of_beckmann = 0.83666003f;

/// Microfacets with the distribution and shadowing of G, a GGX distribution. In the lanes of `separable` the shadowing
/// term is G1(wo) G1(wi). In the lanes of `beckmann` the distribution is Beckmann's, with Walter's rational fit of G1
/// (Walter et al. 2007).
/// Beckmann lanes sample normals by G with alpha times ggx_of_beckmann: the ratio of the densities is at most 1.8, so
/// weights are bounded.
template <class G>
class Facets : public G {
public:
    Facets() = default;
    /// ggx: the distribution that is sampled
    Facets(const G& ggx, Mask beckmann, Mask separable = Mask(false))
        : G(ggx), beckmann_(beckmann), separable_(separable), some_(any(beckmann | separable))
    {
    }

    /// Density of normals at h. d: G::d(h), which callers have computed already.
    Float value(Vec3 h, Float d) const
    {
        if (!some_) return d;
        constexpr float ratio2 = ggx_of_beckmann * ggx_of_beckmann;
        const Float cos2 = max(h.z * h.z, Float(1e-8f));
        const Float b = exp(-this->slope2(h) * Float(ratio2)) * Float(ratio2 * inv_pi) / (this->alpha2() * cos2 * cos2);
        // The lower bound keeps the value positive wherever the sampling density is positive: which directions are
        // valid must not depend on where exp underflows.
        return select(beckmann_, max(b, Float(1e-30f)), d);
    }
    /// Shadowing-masking term.
    Float g2(Vec3 wo, Vec3 wi) const
    {
        const Float g = G::g2(wo, wi);
        if (!some_) return g;
        return select(beckmann_, shadowing(wo) * shadowing(wi), select(separable_, G::g1(wo) * G::g1(wi), g));
    }
    /// Sample weight f_cos / pdf of a direction that was reflected or refracted at the sampled normal h, without the
    /// reflectance.
    Float weight(Vec3 wo, Vec3 wi, Vec3 h) const
    {
        const Float w = g2(wo, wi) / G::g1(wo);
        if (!some_) return w;
        const Float d = G::d(h);
        return w * (value(h, d) / max(d, Float(1e-30f)));
    }

private:
    Float shadowing(Vec3 w) const
    {
        const Float a = Float(ggx_of_beckmann) / sqrt(max(this->stretch2(w), Float(1e-20f)));
        const Float fit =
            a * fma(a, Float(2.181f), Float(3.535f)) / fma(a, fma(a, Float(2.577f), Float(2.276f)), Float(1));
        return select(a < Float(1.6f), fit, Float(1));
    }

    Mask beckmann_{false}, separable_{false};
    bool some_ = false;
};

/// Mirrors w about n: both point away from the surface.
inline Vec3 reflect(Vec3 w, Vec3 n)
{
    return fma(n, Float(2) * dot(w, n), -w);
}

/// Schlick's (1 - cos)^5.
inline Float schlick_weight(Float cosine)
{
    const Float m = clamp(Float(1) - cosine, Float(0), Float(1));
    const Float m2 = m * m;
    return m2 * m2 * m;
}

/// Bilinear interpolation in a row-major table. x, y: column and row, scaled to [0, 1] and clamped; first: index of the
/// table's first entry.
template <int columns, int rows>
inline Float table_lookup(const float* table, Float x, Float y, UInt first)
{
    x = clamp(x, Float(0), Float(1)) * Float(columns - 1), y = clamp(y, Float(0), Float(1)) * Float(rows - 1);
    const Float x0 = min(floor(x), Float(columns - 2)), y0 = min(floor(y), Float(rows - 2));
    const Float fx = x - x0, fy = y - y0;
    const UInt index = to_uint(y0) * UInt(columns) + to_uint(x0) + first;
    const auto at = [&](std::uint32_t offset) { return gather(table, index + UInt(offset)); };
    const Float a = at(0), b = at(1), c = at(columns), d = at(columns + 1);
    const Float top = fma(fx, b - a, a), bottom = fma(fx, d - c, c);
    return fma(fy, bottom - top, top);
}

/// Bilinear lookup in an albedo table of the size of ggx_albedo_table.
inline Float albedo_lookup(const float* table, Float cosine, Float roughness, UInt first = UInt(0))
{
    return table_lookup<ggx_albedo_size, ggx_albedo_size>(table, cosine, roughness, first);
}

/// Directional albedo of perfectly reflecting GGX microfacets, for single scattering.
inline Float ggx_albedo(Float cosine, Float roughness)
{
    return albedo_lookup(ggx_albedo_table, cosine, roughness);
}

/// Directional albedo of a rough dielectric boundary of GGX microfacets, reflection and refraction together, for single
/// scattering. Its inverse compensates for multiple scattering between the facets: Turquin 2019, "Practical multiple
/// scattering compensation for microfacet models".
///
/// eta  index beyond the boundary over index before it; clamped to the table's range of 1/6.2 to 6.2
inline Float dielectric_albedo(Float cosine, Float roughness, Float eta)
{
    constexpr int size = dielectric_albedo_size, slices = dielectric_albedo_indices;
    const Float z = (eta - Float(1)) / (eta + Float(1));
    const Float axis = flip_sign(sqrt(abs(z)), z);
    const Float unit = clamp(fma(axis, Float(0.5f / dielectric_albedo_max_axis), Float(0.5f)), Float(0), Float(1));
    const Float slice = unit * Float(slices - 1), lower = min(floor(slice), Float(slices - 2));
    const UInt first = to_uint(lower) * UInt(size * size);
    const Float a = table_lookup<size, size>(dielectric_albedo_table, cosine, roughness, first);
    const Float b = table_lookup<size, size>(dielectric_albedo_table, cosine, roughness, first + UInt(size * size));
    return fma(slice - lower, b - a, a);
}

/// Reflectance of a smooth boundary between two dielectrics, for unpolarized light.
///
/// cos_theta_i  abs cosine of the angle between direction and normal, in [0, 1]
/// eta          index beyond the boundary over index before it, in [0.01, 100]
/// cos_theta_t  receives the cosine beyond the boundary; 0 for total internal reflection, where the result is exactly 1
///
/// Born and Wolf, Principles of Optics, 1.5.2.
inline Float fresnel_dielectric(Float cos_theta_i, Float eta, Float& cos_theta_t)
{
    const Float sin2_theta_t = (Float(1) - cos_theta_i * cos_theta_i) / (eta * eta);
    const Mask total = sin2_theta_t >= Float(1);
    cos_theta_t = select(total, Float(0), sqrt(max(Float(1) - sin2_theta_t, Float(0))));
    const Float parallel = (eta * cos_theta_i - cos_theta_t) / max(fma(eta, cos_theta_i, cos_theta_t), Float(1e-20f));
    const Float perpendicular =
        (cos_theta_i - eta * cos_theta_t) / max(fma(eta, cos_theta_t, cos_theta_i), Float(1e-20f));
    return select(total, Float(1), Float(0.5f) * fma(parallel, parallel, perpendicular * perpendicular));
}

/// Reflectance of a conductor of index eta + i k in vacuum, for unpolarized light.
///
/// cosine  cosine of the angle between direction and normal, in [0, 1]
///
/// Born and Wolf, Principles of Optics, 14.2, with u + i v = sqrt((eta + i k)^2 - sin^2).
inline Float fresnel_conductor(Float cosine, Float eta, Float k)
{
    const Float cos2 = cosine * cosine, sin2 = Float(1) - cos2;
    const Float real = fma(eta, eta, fma(-k, k, -sin2)), imaginary = Float(2) * eta * k;
    const Float modulus = sqrt(fma(real, real, imaginary * imaginary));  // equals u^2 + v^2
    const Float u = sqrt(max(Float(0.5f) * (modulus + real), Float(0)));
    const Float sum = modulus + cos2, twice = Float(2) * u * cosine;
    const Float perpendicular = (sum - twice) / max(sum + twice, Float(1e-20f));
    const Float other = fma(cos2, modulus, sin2 * sin2), twice_other = twice * sin2;
    const Float ratio = (other - twice_other) / max(other + twice_other, Float(1e-20f));
    return Float(0.5f) * perpendicular * (Float(1) + ratio);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
