#pragma once
#include <optional>
#include <string>
#include <vector>

#include "import/common/spectra.h"
#include "import/pbrt/parameters.h"
#include "scene/conductors.h"

/// The spectra that have names in pbrt-v4.
namespace fathom::pbrt {

/// A standard light by its chromaticity (CIE 15).
struct NamedLight {
    const char* name;
    double x, y;
};
const NamedLight* find_light(const std::string& name);
/// Of "metal-Ag-eta" or "metal-Ag-k": what reflects like it, a colour for each of red, green and blue. Null if it is
/// none or not known here.
const Conductor* find_metal(const std::string& spectrum);
/// Of a glass at 587.6 nm, by its maker's data sheet.
std::optional<double> glass_index(const std::string& name);
bool is_named_spectrum(const std::string& name);

/// Pairs of wavelength and value. Throws Error.
std::vector<SpectrumPoint> spectrum_points(const Parameter& parameter, const std::vector<float>& numbers);
/// The numbers of a spectrum's file.
std::vector<float> numbers_of_file(const std::string& file, const std::string& text);
/// Linear in between, and as at its ends outside.
double value_at(const std::vector<SpectrumPoint>& points, double nm);
double value_at_587(const Parameter& parameter);

}  // namespace fathom::pbrt
