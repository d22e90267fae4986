#pragma once
#include <optional>
#include <string>
#include <vector>

#include "formats/common/spectra.h"
#include "formats/pbrt/parameters.h"
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
/// How glass refracts: its index at 587.6 nm, and Abbe's number, by that index less 1 over how much more it is at 486.1
/// than at 656.3 nm; 0 where all colours are refracted alike.
struct GlassIndex {
    double middle, abbe = 0;
};
/// By its maker's data sheet.
std::optional<GlassIndex> find_glass(const std::string& name);
GlassIndex glass_of(const std::vector<SpectrumPoint>& points);
bool is_named_spectrum(const std::string& name);

/// Pairs of wavelength and value. Throws Error.
std::vector<SpectrumPoint> spectrum_points(const Parameter& parameter, const std::vector<float>& numbers);
/// The numbers of a spectrum's file.
std::vector<float> numbers_of_file(const std::string& file, const std::string& text);
/// Linear in between, and as at its ends outside.
double value_at(const std::vector<SpectrumPoint>& points, double nm);

}  // namespace fathom::pbrt
