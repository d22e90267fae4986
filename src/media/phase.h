// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "sampling/warp.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Samples a direction about +z, the direction of travel, by the phase function of Henyey and Greenstein 1941: (1 -
/// g^2) / (4 pi (1 + g^2 - 2 g cos)^1.5). anisotropy: g, the mean cosine, in [-0.99, 0.99].
///
/// The inverse is cos = (1 + g^2 - ((1 - g^2) / (1 + g x))^2) / 2g with x in [-1, 1]. The division by g is carried out
/// symbolically, which avoids cancellation for small g.
inline Vec3 sample_phase(Float anisotropy, Sample2 u)
{
    const Float g = anisotropy, g2 = g * g, x = fma(u.x, Float(2), Float(-1)), root = fma(g, x, Float(1));
    const Float above = fma(x, Float(2) * (Float(1) + g2), g * (Float(3) - g2 + x * x * (Float(1) + g2)));
    const Float cosine = clamp(above / (Float(2) * root * root), Float(-1), Float(1));
    const Float sine = sqrt(max(fma(-cosine, cosine, Float(1)), Float(0)));
    const SinCos phi = sincos_2pi(u.y);
    return {sine * phi.cos, sine * phi.sin, cosine};
}

/// Density of sample_phase() with respect to solid angle. cosine: cosine of the angle to the direction of travel.
inline Float phase_pdf(Float anisotropy, Float cosine)
{
    const Float g = anisotropy, g2 = g * g;
    const Float way2 = max(fma(Float(-2) * g, cosine, Float(1) + g2), Float(1e-4f));
    return Float(0.25f * inv_pi) * (Float(1) - g2) / (way2 * sqrt(way2));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
