#pragma once
#include <string_view>
#include <vector>

#include "fathom/vector.h"

/// Spectra as linear Rec.709, by the colour matching functions of C. Wyman, P.-P. Sloan and P. Shirley: Simple Analytic
/// Approximations to the CIE XYZ Color Matching Functions, 2013.
namespace fathom {

/// A value at a wavelength, nm; linear in between, 0 before the first and after the last.
struct SpectrumPoint {
    double wavelength, value;
};
/// Of light: a spectrum of 1 at all wavelengths has a luminance of 1.
Color color_of_light(const std::vector<SpectrumPoint>& points);
/// In daylight, D65: a spectrum of 1 at all wavelengths is white.
Color color_in_daylight(const std::vector<SpectrumPoint>& points);
/// The same of what a surface reflects: 0 to 1.
Color color_of_surface(const std::vector<SpectrumPoint>& points);
/// Radiance of a black body, W/(m2 sr nm), of a temperature in kelvin.
Color color_of_black_body(double temperature);

}  // namespace fathom
