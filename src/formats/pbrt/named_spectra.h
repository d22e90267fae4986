// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "formats/common/spectra.h"
#include "formats/pbrt/parameters.h"
#include "scene/conductors.h"

/// The named spectra of pbrt-v4.
namespace fathom::pbrt {

/// A standard illuminant with its chromaticity (CIE 15).
struct NamedLight {
    const char* name;
    double x, y;
};
/// Looks up a standard illuminant by name; null if there is none.
const NamedLight* find_light(const std::string& name);
/// The conductor of a spectrum named "metal-Ag-eta" or "metal-Ag-k"; null if the spectrum is another one or unknown.
const Conductor* find_metal(const std::string& spectrum);
/// Dispersion of a glass: its index at 587.6 nm and its Abbe number, (index - 1) over the difference of the indices at
/// 486.1 and 656.3 nm. An Abbe number of 0 means no dispersion.
struct GlassIndex {
    double middle, abbe = 0;
};
/// Index of a named glass, from its manufacturer's data sheet.
std::optional<GlassIndex> find_glass(const std::string& name);
/// Index and Abbe number of a spectrum of indices of refraction.
GlassIndex glass_of(const std::vector<SpectrumPoint>& points);
/// Whether a name has the form of pbrt-v4's named spectra rather than of a file name.
bool is_named_spectrum(const std::string& name);

/// Pairs of wavelength and value of a spectrum. Throws Error.
std::vector<SpectrumPoint> spectrum_points(const Parameter& parameter, const std::vector<float>& numbers);
/// The numbers in a spectrum file. Throws Error.
std::vector<float> numbers_of_file(const std::string& file, const std::string& text);
/// Interpolates linearly; constant beyond the first and last point.
double value_at(const std::vector<SpectrumPoint>& points, double nm);

}  // namespace fathom::pbrt
