// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>
#include <vector>

#include "fathom/vector.h"

/// Conversion of spectra to linear Rec.709, with the color matching functions of C. Wyman, P.-P. Sloan and P. Shirley,
/// "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", 2013.
namespace fathom {

/// A sample of a spectrum at a wavelength in nm. Spectra are linear between samples and 0 outside their range.
struct SpectrumPoint {
    double wavelength, value;
};
/// Color of an emission spectrum; the constant spectrum 1 has luminance 1.
Color color_of_light(const std::vector<SpectrumPoint>& points);
/// Color of a reflectance spectrum under D65; the constant spectrum 1 is white.
Color color_in_daylight(const std::vector<SpectrumPoint>& points);
/// Color of a reflectance spectrum under D65, clamped to [0, 1].
Color color_of_surface(const std::vector<SpectrumPoint>& points);
/// Spectral radiance of a black body in W/(m2 sr nm) as a color, at a temperature in kelvin.
Color color_of_black_body(double temperature);

}  // namespace fathom
