// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "materials/microfacet/microfacet.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Response of the CIE's color matching functions to the m-th interference term of a film, as XYZ converted to Rec.709:
/// Gaussians fitted to the functions' Fourier transforms. way: optical path difference in nanometers; shift: phase
/// shift per channel.
inline Spectrum film_sensitivity(Float way, const Spectrum& shift)
{
    // Positions are in 1/m, variances in 1/m^2, heights without the factor sqrt(2 pi variance).
    constexpr float height[] = {5.4856e-13f, 4.4201e-13f, 5.2481e-13f}, position[] = {1.6810e6f, 1.7953e6f, 2.2084e6f},
                    variance[] = {4.3278e9f, 9.3046e9f, 6.6121e9f};
    constexpr float second_height = 9.7470e-14f, second_position = 2.2399e6f, second_variance = 4.5282e9f;
    constexpr float norm = 1 / 1.0685e-7f, two_pi = 2 * pi, per_turn = 1 / two_pi;
    // Newton's method computes sqrt(2 pi variance): std::sqrt is not constexpr.
    constexpr auto root = [](double x) {
        double y = x > 1 ? x : 1;
        for (int i = 0; i < 60; ++i) y = 0.5 * (y + x / y);
        return y;
    };
    const Float phase = way * Float(two_pi * 1e-9f), phase2 = phase * phase;
    const auto term = [&](float h, float p, float v, Float by) {
        const Float turns = fma(phase, Float(p), by) * Float(per_turn);
        return Float(float(h * root(2 * double(pi) * v)) * norm) * sincos_2pi(turns - floor(turns)).cos *
               exp(-(phase2 * Float(v)));
    };
    Float xyz[3];
    for (int i = 0; i < 3; ++i) xyz[i] = term(height[i], position[i], variance[i], shift.c[i]);
    xyz[0] = xyz[0] + term(second_height, second_position, second_variance, shift.c[0]);
    constexpr float rgb_of_xyz[3][3] = {{3.2404542f, -1.5371385f, -0.4985314f},
                                        {-0.9692660f, 1.8760108f, 0.0415560f},
                                        {0.0556434f, -0.2040259f, 1.0572252f}};
    Spectrum rgb;
    for (int i = 0; i < channels; ++i) {
        const float* row = rgb_of_xyz[i];
        rgb.c[i] = fma(xyz[0], Float(row[0]), fma(xyz[1], Float(row[1]), xyz[2] * Float(row[2])));
    }
    return rgb;
}

}  // namespace detail

/// Reflectance of a base under a thin film, by interference between the film's two boundaries: Belcour and Barla 2017,
/// "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", in the form of
/// KHR_materials_iridescence, with Schlick's Fresnel terms.
///
/// cosine     abs cosine between direction and microfacet normal
/// f0         reflectance of the base at normal incidence, without the film
/// thickness  nanometers
/// ior        refractive index of the film
inline Spectrum thin_film_reflectance(Float cosine, const Spectrum& f0, Float thickness, Float ior)
{
    const Float inverse = Float(1) / ior;
    const Float cos2_film = fma(-(inverse * inverse), fma(-cosine, cosine, Float(1)), Float(1));
    const Mask total = cos2_film < Float(0);
    const Float cos_film = sqrt(max(cos2_film, Float(0)));
    const auto schlick = [](Float r0, Float w) { return fma(Float(1) - r0, w, r0); };

    // Boundary from air to film.
    const Float root = (ior - Float(1)) / (ior + Float(1));
    const Float r12 = schlick(root * root, schlick_weight(cosine)), t121 = Float(1) - r12;
    const Mask thinner = ior < Float(1);
    const Float shift21 = select(thinner, Float(0), Float(pi));
    // Boundary from film to base.
    Spectrum r23, shift;
    for (int i = 0; i < channels; ++i) {
        const Float s = sqrt(clamp(f0.c[i] + Float(1e-4f), Float(0), Float(0.9999f)));
        const Float base_ior = (Float(1) + s) / (Float(1) - s);
        const Float r = (base_ior - ior) / (base_ior + ior);
        r23.c[i] = schlick(r * r, schlick_weight(cos_film));
        shift.c[i] = shift21 + select(base_ior < ior, Float(pi), Float(0));
    }
    const Float way = Float(2) * ior * thickness * cos_film;
    Spectrum sum, amplitude, step;
    for (int i = 0; i < channels; ++i) {
        const Float r123 = clamp(r12 * r23.c[i], Float(1e-5f), Float(0.9999f));
        const Float once = t121 * t121 * r23.c[i] / (Float(1) - r123);
        sum.c[i] = r12 + once;
        amplitude.c[i] = once - t121;
        step.c[i] = sqrt(r123);
    }
    for (int m = 1; m <= 2; ++m) {
        amplitude = amplitude * step;
        const Spectrum s = detail::film_sensitivity(way * Float(float(m)), shift * Float(float(m)));
        for (int i = 0; i < channels; ++i) sum.c[i] = fma(amplitude.c[i] * Float(2), s.c[i], sum.c[i]);
    }
    for (int i = 0; i < channels; ++i) sum.c[i] = select(total, Float(1), clamp(sum.c[i], Float(0), Float(1)));
    return sum;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
