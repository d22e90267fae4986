#pragma once
#include <array>

#include "fathom/image.h"

namespace fathom {

/// Of ITU-R BT.709 and its white, D65.
inline constexpr Chromaticities rec709_chromaticities{{0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3127f, 0.329f}};
/// Of ACEScg: AP1 and the white of ACES, near D60 (Academy S-2014-004).
inline constexpr Chromaticities acescg_chromaticities{
    {0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}};

Chromaticities chromaticities_of(Primaries primaries);

/// Whether they are the same as files round them.
bool is_same(const Chromaticities& a, const Chromaticities& b);

/// Rows that take linear colours of one kind to another, white to white: adapted by Bradford's cones, as ACES does it.
/// Throws Error where primaries are no triangle or white is black.
using ColorMatrix = std::array<std::array<double, 3>, 3>;
ColorMatrix conversion(const Chromaticities& from, const Chromaticities& to);

/// The chromaticity of light of a temperature in kelvin, 1000 to 25000: of daylight from 4000 on (CIE 15, in which D65
/// has 6504), of a black body below, for which daylight is not defined.
Vec2f white_of(double kelvin);

/// Of linear Rec.709: what is lit by light of this temperature as if it were lit by D65.
ColorMatrix white_balance(double kelvin);

/// Red, green and blue of the layer, if it has them, by the matrix. Values that are not finite stay as they are.
void convert(Image::Layer& layer, const ColorMatrix& matrix);

}  // namespace fathom
