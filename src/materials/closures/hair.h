// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/closures/closure.h"
#include "materials/hair_color.h"
#include "materials/lobes/hair_lobe.h"
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Parameters of HairBsdf, with textures applied: see HairRecord.
struct HairPoint : MaterialPoint {
    using Record = HairRecord;
    Float beta_m, beta_n;  ///< longitudinal and azimuthal roughness
    Float ior;
    Float scale_tilt;  ///< tilt of the scales in radians
    Float across{0};   ///< offset of the hit across the fiber's width, -1 to 1 along the frame's y

    void read(const ParameterReader<Record>& r)
    {
        beta_m = r.number(&Record::beta_m, &Record::beta_m_texture);
        beta_n = r.number(&Record::beta_n, &Record::beta_n_texture);
        ior = r.get(&Record::ior);
        scale_tilt = r.get(&Record::scale_tilt);
    }
};

/// Hair fiber: a rough dielectric cylinder with absorption, whose scales are tilted. A scattering event covers all
/// paths inside the fiber: reflection (R), transmission (TT), one internal reflection (TRT), and all longer ones, each
/// with a lobe. Chiang, Bitterli, Tappan, Burley 2016, "A Practical and Controllable Hair and Fur Model for Production
/// Path Tracing"; Marschner et al. 2003, "Light Scattering from Human Hair Fibers"; Pharr, Jakob, Humphreys 2023,
/// "Physically Based Rendering", 9.9.
///
/// The frame's x is along the fiber, its y across it as seen by the path; `across` is measured along y. Angle theta is
/// measured from the plane across the fiber, phi around the fiber from y to z, gamma from the cylinder's normal to the
/// path.
class HairBsdf : public ClosureOf<ClosureKind::hair, HairPoint> {
public:
    static constexpr bool transmits = true;
    static constexpr bool is_glossy = false;
    static constexpr bool is_fiber = true;

    explicit HairBsdf(const HairPoint& m)
        : h_(clamp(m.across, Float(-1), Float(1))), eta_(clamp(m.ior, Float(1), Float(3)))
    {
        const Float beta_m = clamp(m.beta_m, Float(min_beta), Float(1)),
                    beta_n = clamp(m.beta_n, Float(min_beta), Float(1));
        absorption_ = hair_absorption(m.base_color, beta_n);
        const auto to_20 = [](Float x) {
            const Float x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
            return x8 * x8 * x4;
        };
        // Maps a perceptually uniform roughness to variance and logistic scale: Chiang et al. 2016, equations 7 and 8.
        const Float width = fma(to_20(beta_m), Float(3.7f), beta_m * fma(beta_m, Float(0.812f), Float(0.726f)));
        const Float v = width * width;
        along_[0] = HairLongitudinal(v), along_[1] = HairLongitudinal(Float(0.25f) * v);
        along_[2] = along_[3] = HairLongitudinal(Float(4) * v);
        constexpr float root_of_pi_8 = 0.626657069f;
        const Float beta_n2 = beta_n * beta_n;
        around_ = HairAzimuthal(Float(root_of_pi_8) * fma(to_20(beta_n) * beta_n2, Float(5.372f),
                                                          fma(beta_n2, Float(1.194f), beta_n * Float(0.265f))));
        // The tilt of the scales shifts R towards the root by twice their angle, TT towards the tip by once and TRT by
        // four times their angle.
        constexpr float turns[] = {-2, 1, 4, 0};
        for (int p = 0; p < lobes; ++p) tilt_[p] = sincos_2pi(m.scale_tilt * Float(turns[p] * 0.5f * inv_pi));
    }
    BsdfEval eval(Vec3 wo, Vec3 wi) const { return evaluate(Path(*this, wo), wi); }
    BsdfSample sample(Vec3 wo, Sample2 u, Float u1) const
    {
        const Path path(*this, wo);
        // Selects the last lobe that begins below u1; the position of u1 within the lobe's interval samples the
        // azimuth.
        Float begin(0), first(0), share(1), sin_i(0), turn(0);
        for (int p = 0; p < lobes; ++p) {
            const Mask here = u1 >= begin;
            const SinCos theta = tilted(path, p);
            sin_i = select(here, along_[p].sample(theta.sin, theta.cos, u), sin_i);
            turn = select(here, middle(path, p), turn);
            first = select(here, begin, first), share = select(here, path.share[p], share);
            begin = begin + path.share[p];
        }
        const Mask is_rest = u1 >= begin - path.share[lobes - 1];
        const Float rest = clamp((u1 - first) / max(share, Float(1e-20f)), Float(0), Float(1 - 0x1p-24f));
        const Float off = select(is_rest, rest * Float(2 * pi), around_.sample(rest));
        const SinCos phi = sincos_2pi((path.phi + turn + off) * Float(0.5f * inv_pi));
        const Float cos_i = sqrt(max(fma(-sin_i, sin_i, Float(1)), Float(0)));
        const Vec3 wi = normalize(Vec3(sin_i, cos_i * phi.cos, cos_i * phi.sin));
        const BsdfEval e = evaluate(path, wi);
        const Mask valid = e.pdf > Float(0);
        return {wi, e.f_cos * select(valid, Float(1) / max(e.pdf, Float(1e-30f)), Float(0)), e.pdf, Mask(false),
                Float(1)};
    }

private:
    /// Number of lobes: R, TT, TRT, and all longer paths.
    static constexpr int lobes = 4;
    static constexpr float min_beta = 0.01f;

    /// Geometry of wo on the fiber, and attenuation and selection probability of each lobe.
    struct Path {
        SinCos theta;
        Float phi, gamma,
            gamma_t;  ///< azimuth of wo, and its angles from the cylinder's normal; gamma_t: inside the fiber
        Spectrum attenuation[lobes];
        Float share[lobes];  ///< selection probability of the lobe

        Path(const HairBsdf& hair, Vec3 wo)
        {
            const auto asin_of = [](Float sine, Float& cosine) {
                cosine = sqrt(max(fma(-sine, sine, Float(1)), Float(0)));
                return atan2(sine, cosine);
            };
            theta = {clamp(wo.x, Float(-1), Float(1)), sqrt(fma(wo.y, wo.y, wo.z * wo.z))};
            phi = atan2(wo.z, wo.y);
            Float cos_gamma, cos_gamma_t;
            gamma = asin_of(hair.h_, cos_gamma);
            // The index of refraction differs in projection along the fiber (Bravais): Marschner et al. 2003, appendix
            // B.
            const Float sin2 = theta.sin * theta.sin, eta2 = hair.eta_ * hair.eta_;
            const Float beyond = sqrt(max(eta2 - sin2, Float(1e-10f)));  // eta times the cosine of theta inside
            gamma_t = asin_of(clamp(hair.h_ * theta.cos / beyond, Float(-1), Float(1)), cos_gamma_t);
            const Float way = Float(2) * cos_gamma_t * hair.eta_ / beyond;
            Float unused;
            const Float f = fresnel_dielectric(min(theta.cos * cos_gamma, Float(1)), hair.eta_, unused);
            const Float in_and_out = (Float(1) - f) * (Float(1) - f);
            Float sum(0);
            for (int c = 0; c < channels; ++c) {
                const Float t = exp(-hair.absorption_.c[c] * way), back = t * f;
                attenuation[0].c[c] = f;
                attenuation[1].c[c] = in_and_out * t;
                attenuation[2].c[c] = attenuation[1].c[c] * back;
                attenuation[3].c[c] = attenuation[2].c[c] * back / max(Float(1) - back, Float(1e-6f));
            }
            for (int p = 0; p < lobes; ++p) share[p] = mean(attenuation[p]), sum = sum + share[p];
            const Float scale = Float(1) / max(sum, Float(1e-20f));
            for (Float& s : share) s = s * scale;
        }
    };

    /// theta of wo, shifted for a lobe by the tilt of the scales.
    SinCos tilted(const Path& path, int p) const
    {
        const SinCos &a = path.theta, &b = tilt_[p];
        return {fma(a.sin, b.cos, a.cos * b.sin), abs(fma(a.cos, b.cos, -(a.sin * b.sin)))};
    }
    /// Azimuth at which a smooth fiber sends the light of a lobe, relative to wo, in radians.
    static Float middle(const Path& path, int p)
    {
        if (p == lobes - 1) return Float(0);
        return fma(path.gamma_t, Float(2.f * float(p)), fma(path.gamma, Float(-2), Float(float(p) * pi)));
    }
    BsdfEval evaluate(const Path& path, const Vec3& wi) const
    {
        const Float sin_i = clamp(wi.x, Float(-1), Float(1)), cos_i = sqrt(fma(wi.y, wi.y, wi.z * wi.z));
        const Float phi = atan2(wi.z, wi.y) - path.phi;
        BsdfEval r{Spectrum(Float(0)), Float(0)};
        for (int p = 0; p < lobes; ++p) {
            const SinCos theta = tilted(path, p);
            const Float around = p == lobes - 1 ? Float(0.5f * inv_pi) : around_.pdf(phi - middle(path, p));
            const Float lobe = along_[p].pdf(sin_i, cos_i, theta.sin, theta.cos) * around;
            r.f_cos = fma(path.attenuation[p], lobe, r.f_cos);
            r.pdf = fma(path.share[p], lobe, r.pdf);
        }
        return r;
    }

    Float h_, eta_;
    Spectrum absorption_;
    HairLongitudinal along_[lobes];
    HairAzimuthal around_;
    SinCos tilt_[lobes];
};

}  // namespace FATHOM_LANES
}  // namespace fathom
