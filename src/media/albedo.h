// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "math/spectrum.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Vector version of single_scattering_albedo() in scene/scattering.h: the albedo of a medium whose half-space reflects
/// the fraction `color` of diffuse light.
inline Spectrum scattering_albedo(const Spectrum& color, Float anisotropy)
{
    Spectrum albedo;
    for (int k = 0; k < channels; ++k) {
        const Float c = clamp(color.c[k], Float(0), Float(1)), b = fma(c, Float(1.17f), Float(1.139f));
        const Float root = sqrt(fma(b, b, (c - Float(1)) * Float(4 * 0.139f)));
        // Vieta's form of (b - root) / (2 * 0.139) is used, since the subtraction would cancel for bright media.
        const Float s = Float(2) * (Float(1) - c) / (b + root), s2 = s * s;
        albedo.c[k] = select(c > Float(0), (Float(1) - s2) / fma(-anisotropy, s2, Float(1)), Float(0));
    }
    return albedo;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
