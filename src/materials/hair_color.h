// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Conversion between the absorption of a hair fiber and the color that many such hairs show.
#include "math/elementary.h"
#include "math/spectrum.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Factor between the square root of a fiber's absorption and the negative logarithm of the hair's color, by azimuthal
/// roughness: Chiang, Bitterli, Tappan, Burley 2016, "A Practical and Controllable Hair and Fur Model for Production
/// Path Tracing", 4.2.
inline Float hair_color_fit(Float roughness)
{
    const Float beta_n = clamp(roughness, Float(0.01f), Float(1));
    constexpr float fit[] = {0.245f, 5.574f, -10.73f, 2.532f, -0.215f, 5.969f};
    Float sum(fit[0]);
    for (std::size_t k = 1; k < std::size(fit); ++k) sum = fma(sum, beta_n, Float(fit[k]));
    return sum;
}

}  // namespace detail

/// Absorption of a fiber over its radius, per channel, for which a volume of such hairs has the color `color`. beta_n:
/// azimuthal roughness, 0.01 to 1.
inline Spectrum hair_absorption(const Spectrum& color, Float beta_n)
{
    const Float scale = Float(1) / detail::hair_color_fit(beta_n);
    Spectrum sigma;
    for (int i = 0; i < channels; ++i) {
        const Float root = log(clamp(color.c[i], Float(1e-30f), Float(1))) * scale;
        sigma.c[i] = root * root;
    }
    return sigma;
}
/// Inverse of hair_absorption.
inline Spectrum hair_color(const Spectrum& absorption, Float beta_n)
{
    const Float scale = -detail::hair_color_fit(beta_n);
    Spectrum color;
    for (int i = 0; i < channels; ++i) color.c[i] = exp(sqrt(max(absorption.c[i], Float(0))) * scale);
    return color;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
