// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

namespace fathom {

/// Single-scattering albedo of a medium whose half-space reflects the fraction `color` under uniform illumination.
///
/// Inverts van de Hulst's color = (1 - s) (1 - 0.139 s) / (1 + 1.17 s), where s^2 = (1 - albedo) / (1 - anisotropy
/// albedo) (1980, "Multiple Light Scattering", volume 2). OpenPBR and glTF use the formula with rounded constants,
/// after Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks".
///
/// color       reflected fraction, in [0, 1]
/// anisotropy  mean cosine of the phase function, in (-1, 1)
inline double single_scattering_albedo(double color, double anisotropy)
{
    if (color <= 0) return 0;
    const double b = 1.139 + 1.17 * color;
    const double s = (b - std::sqrt(b * b - 4 * 0.139 * (1 - color))) / (2 * 0.139);
    return std::clamp((1 - s * s) / (1 - anisotropy * s * s), 0.0, 1.0);
}

}  // namespace fathom
