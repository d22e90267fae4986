// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "fathom/image.h"

namespace fathom {

/// Primaries of ITU-R BT.709 with white D65.
inline constexpr Chromaticities rec709_chromaticities{{0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3127f, 0.329f}};
/// Primaries of ACEScg: AP1 with the white of ACES, near D60 (Academy S-2014-004).
inline constexpr Chromaticities acescg_chromaticities{
    {0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}};

/// Chromaticities of named primaries.
Chromaticities chromaticities_of(Primaries primaries);

/// Whether two sets of chromaticities agree up to the rounding that files apply.
bool is_same(const Chromaticities& a, const Chromaticities& b);

/// Matrix from one linear color space to another, with chromatic adaptation of white by Bradford's transform, as in
/// ACES. Throws Error if primaries are collinear or a white has y = 0.
using ColorMatrix = std::array<std::array<double, 3>, 3>;
ColorMatrix conversion(const Chromaticities& from, const Chromaticities& to);

/// Chromaticity (CIE 1931 xy) of light of a color temperature in kelvin, in [1000, 25000]: a CIE daylight illuminant
/// from 4000 K on (CIE 15; D65 has 6504 K), a black body below, where daylight is not defined.
Vec2f white_chromaticity(double kelvin);

/// White balance in linear Rec.709: adapts colors under light of this temperature to D65.
ColorMatrix white_balance(double kelvin);

/// Applies the matrix to the layer's red, green and blue, if it has them. Non-finite values are left unchanged.
void convert(Image::Layer& layer, const ColorMatrix& matrix);

}  // namespace fathom
