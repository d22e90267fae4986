// SPDX-License-Identifier: Apache-2.0
#include "formats/pbrt/named_spectra.h"

#include <algorithm>

namespace fathom::pbrt {

namespace {

constexpr NamedLight lights[] = {
    {"stdillum-A", 0.44757, 0.40745},   {"stdillum-D50", 0.34567, 0.35850}, {"stdillum-D65", 0.31271, 0.32902},
    {"stdillum-F1", 0.31310, 0.33727},  {"stdillum-F2", 0.37208, 0.37529},  {"stdillum-F3", 0.40910, 0.39430},
    {"stdillum-F4", 0.44018, 0.40329},  {"stdillum-F5", 0.31379, 0.34531},  {"stdillum-F6", 0.37790, 0.38835},
    {"stdillum-F7", 0.31292, 0.32933},  {"stdillum-F8", 0.34588, 0.35875},  {"stdillum-F9", 0.37417, 0.37281},
    {"stdillum-F10", 0.34609, 0.35986}, {"stdillum-F11", 0.38052, 0.37713}, {"stdillum-F12", 0.43695, 0.40441},
    {"illum-acesD60", 0.32168, 0.33767}};

/// Indices fitted to the color under D65 that pbrt's spectra reflect at normal incidence and at 82 degrees, in air and
/// in a coat of index 1.5. Errors are up to 0.002, and 0.005 for the red of gold (limited to 1 here, 1.02 in pbrt).
/// Indices sampled at three wavelengths would be off by up to 0.03.
constexpr Conductor metals[] = {{"Ag", {0.1291f, 0.1242f, 0.1511f}, {4.107f, 3.335f, 2.411f}},
                                {"Al", {1.428f, 0.9292f, 0.5908f}, {7.737f, 6.605f, 5.361f}},
                                {"Au", {0.7772f, 0.41f, 1.555f}, {30.49f, 2.359f, 1.711f}},
                                {"Cu", {0.1421f, 0.9761f, 1.208f}, {3.324f, 2.621f, 2.363f}},
                                {"CuZn", {0.4374f, 0.5213f, 1.122f}, {4.134f, 2.661f, 1.807f}},
                                {"MgO", {1.734f, 1.739f, 1.748f}, {0, 0.02408f, 0.04351f}},
                                {"TiO2", {2.86f, 2.956f, 3.186f}, {0, 0.03111f, 0}}};

struct NamedGlass {
    const char* name;
    GlassIndex index;
};
/// Glasses of Schott. pbrt omits the S in three of the names.
constexpr NamedGlass glasses[] = {{"glass-BK7", {1.5168, 64.17}},   {"glass-BAF10", {1.6700, 47.11}},
                                  {"glass-FK51A", {1.4866, 84.47}}, {"glass-LASF9", {1.8503, 32.17}},
                                  {"glass-F5", {1.6727, 32.21}},    {"glass-SF5", {1.6727, 32.21}},
                                  {"glass-F10", {1.7283, 28.41}},   {"glass-SF10", {1.7283, 28.41}},
                                  {"glass-F11", {1.7847, 25.76}},   {"glass-SF11", {1.7847, 25.76}}};

}  // namespace

const NamedLight* find_light(const std::string& name)
{
    const auto* const found =
        std::find_if(std::begin(lights), std::end(lights), [&](const NamedLight& l) { return name == l.name; });
    return found == std::end(lights) ? nullptr : found;
}

const Conductor* find_metal(const std::string& spectrum)
{
    for (const Conductor& metal : metals)
        for (const char* what : {"-eta", "-k"})
            if (spectrum == "metal-" + std::string(metal.name) + what) return &metal;
    return nullptr;
}

std::optional<GlassIndex> find_glass(const std::string& name)
{
    for (const NamedGlass& glass : glasses)
        if (name == glass.name) return glass.index;
    return std::nullopt;
}

bool is_named_spectrum(const std::string& name)
{
    for (const char* start : {"metal-", "glass-", "canon_", "nikon_", "sony_"})
        if (name.starts_with(start)) return name.find('.') == std::string::npos;
    return false;
}

double value_at(const std::vector<SpectrumPoint>& points, double nm)
{
    const auto after = std::upper_bound(points.begin(), points.end(), nm,
                                        [](double x, const SpectrumPoint& p) { return x < p.wavelength; });
    if (after == points.begin()) return points.front().value;
    const SpectrumPoint& before = *(after - 1);
    if (after == points.end()) return before.value;
    return before.value +
           (nm - before.wavelength) / (after->wavelength - before.wavelength) * (after->value - before.value);
}

GlassIndex glass_of(const std::vector<SpectrumPoint>& points)
{
    GlassIndex glass{value_at(points, 587.6)};
    // Normal dispersion: the index grows toward blue.
    if (const double spread = value_at(points, 486.1) - value_at(points, 656.3); spread > 0)
        glass.abbe = (glass.middle - 1) / spread;
    return glass;
}

}  // namespace fathom::pbrt
