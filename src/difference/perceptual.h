// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

/// Color spaces and color metric of FLIP (Andersson et al. 2020, section 4.1). Colors are linear Rec.709.
namespace fathom::perceptual {

using Triple = std::array<float, 3>;

/// Linear CIELAB (Zhang and Wandell 1997): an achromatic, a red-green and a blue-yellow channel.
Triple ycxcz_from_linear(const Triple& rgb);
Triple linear_from_ycxcz(const Triple& ycxcz);
/// Luminance relative to white.
float relative_luminance(const Triple& rgb);
/// CIELAB with chroma that grows with lightness (Hunt 1952), of a color in [0, 1].
Triple hunt_lab(const Triple& rgb);
/// Color difference from 0 to 1: HyAB (Abasi et al. 2020), compressed such that large differences take the upper 5 %.
float color_difference(const Triple& hunt_a, const Triple& hunt_b);

}  // namespace fathom::perceptual
