// SPDX-License-Identifier: Apache-2.0
// Conversion of conductors, whose reflectance follows from indices of refraction.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/io/read_file.h"
#include "formats/pbrt/named_spectra.h"
#include "formats/pbrt/reader.h"
#include "scene/conductors.h"

namespace fathom::pbrt {

namespace {

/// Color of the spectral Fresnel reflectance under D65.
Color reflectance(const std::vector<SpectrumPoint>& eta, const std::vector<SpectrumPoint>& k, double outside,
                  double cosine)
{
    std::vector<SpectrumPoint> points;
    for (int nm = 360; nm <= 830; nm += 5)
        points.push_back(
            {double(nm), conductor_reflectance(cosine, value_at(eta, nm) / outside, value_at(k, nm) / outside)});
    return color_of_surface(points);
}

float edge_tint(float at_normal, float at_edge)
{
    const double schlick = at_normal + (1 - at_normal) * std::pow(6.0 / 7, 5);
    return float(std::clamp(at_edge / schlick, 0.0, 1.0));
}

/// pbrt's conductor for a given reflectance at normal incidence in air: eta is 1, and k follows from the reflectance.
Conductor conductor_of_reflectance(const Color& color)
{
    const auto k = [](float r) {
        const double limited = std::min(double(r), 0.9999);
        return float(2 * std::sqrt(limited / (1 - limited)));
    };
    return {"", {1, 1, 1}, {k(color.r), k(color.g), k(color.b)}};
}

double inner_cosine(double cosine, double ior)
{
    return std::sqrt(std::max(1 - (1 - cosine * cosine) / (ior * ior), 0.0));
}

/// The edge tint (the factor to Schlick's reflectance at 82 degrees) of a metal below a smooth coat. It is the
/// least-squares fit of Fathom's layered model to the exact interreflection between coat and metal, over uniform
/// illumination. Refraction limits angles below the coat to about 42 degrees, where metals reflect as at normal
/// incidence.
///
/// base  the metal's reflectance at normal incidence
/// left  factor by which Fathom's coat color attenuates
float fit_edge_tint_below_coat(double base, double ior, double thickness, double left)
{
    const double root = (ior - 1) / (ior + 1), f0 = root * root, f90 = std::min(50 * f0, 1.0);
    const double at_82 = std::lerp(base, 1.0, std::pow(6.0 / 7, 5)) / (std::pow(6.0 / 7, 6) / 7);
    constexpr int steps = 64;
    double product = 0, square = 0;
    for (int i = 0; i < steps; ++i) {
        const double cosine = std::sqrt((i + 0.5) / steps), schlick = std::pow(1 - cosine, 5);
        const double f = conductor_reflectance(cosine, ior, 0);
        const double passed = base * std::exp(-2 * thickness / inner_cosine(cosine, ior));
        const double wanted = f + (1 - f) * (1 - f) * passed / (1 - f * passed);
        const double coat = std::lerp(f0, f90, schlick), under = (1 - coat) * left * (1 - f0) / (1 - f0 * base);
        const double side = under * at_82 * cosine * std::pow(1 - cosine, 6);
        const double without = coat + under * std::lerp(base, 1.0, schlick) - side;
        product += side * (wanted - without), square += side * side;
    }
    return float(std::clamp(product / square, 0.0, 1.0));
}

/// Roughness of a metal seen through a rough coat, by adding variances. The metal's deflections grow by the factor ior
/// on leaving the coat. The coat's facets deflect light twice, each time by ior - 1 relative to a mirror.
float roughness_through_coat(float base, float coat, float ior)
{
    const float base_alpha = base * base * ior, coat_alpha = coat * coat * (ior - 1);
    return std::min(std::pow(base_alpha * base_alpha + coat_alpha * coat_alpha / 2, 0.25f), 1.f);
}

void set_metal(const Conductor& conductor, Material& out)
{
    const ConductorColors colors = colors_of(conductor);
    out.base_color = {colors.base, -1}, out.conductor.edge_color = {colors.edge, -1};
    out.conductor.eta = conductor.eta, out.conductor.k = conductor.k;
}

}  // namespace

void Reader::set_metal_colors(const Parameters& m, const std::string& prefix, float outside, Material& out)
{
    const auto set = [&](const ConductorColors& colors) {
        out.base_color = {colors.base, -1}, out.conductor.edge_color = {colors.edge, -1};
    };
    const Parameter *const eta = m.find(prefix + "eta"), *const k = m.find(prefix + "k");
    const auto name = [](const Parameter* p) { return p && p->strings.size() == 1 ? p->strings[0] : std::string(); };
    const auto is_plain = [](const Parameter* p) { return p && (p->type == "rgb" || p->type == "float"); };
    if (is_plain(eta) && is_plain(k)) {
        const Conductor plain{"", color_value(m, *eta, true), color_value(m, *k, true)};
        return set_metal(within(plain, outside), out);
    }
    // A spectrum is given by pairs of wavelength and value, inline or in a file.
    const auto is_spectrum = [&](const Parameter* p) {
        return p && (p->numbers.size() > 1 || (!name(p).empty() && !is_named_spectrum(name(p))));
    };
    if (is_spectrum(eta) && is_spectrum(k)) {
        const auto points = [&](const Parameter& p) {
            return spectrum_points(p, p.numbers.empty() ? spectrum_file(p) : p.numbers);
        };
        const auto n_points = points(*eta), k_points = points(*k);
        const Color base = reflectance(n_points, k_points, outside, 1),
                    edge = reflectance(n_points, k_points, outside, 1.0 / 7);
        return set({base, {edge_tint(base.r, edge.r), edge_tint(base.g, edge.g), edge_tint(base.b, edge.b)}});
    }
    const std::string spectrum = eta ? name(eta) : "metal-Cu-eta";
    const Conductor* metal = find_metal(spectrum);
    if (!metal) {
        report(m, fmt::format("the metal '{}' is unknown: aluminum is used", printable(spectrum)));
        metal = find_metal("metal-Al-eta");
    }
    set(colors_of(within(*metal, outside)));
}

Material Reader::conductor(const Parameters& m, const std::string& prefix, float outside)
{
    Material out;
    out.kind = MaterialKind::principled;
    out.metallic = {1, -1, 0};
    if (m.has("reflectance")) {
        out.base_color = color(m, "reflectance", {0.5f, 0.5f, 0.5f});
        // Textures keep Schlick's approximation.
        if (out.base_color.texture < 0) {
            set_metal(within(conductor_of_reflectance(out.base_color.value), outside), out);
        }
        m.ignore({prefix + "eta", prefix + "k"});
    } else {
        set_metal_colors(m, prefix, outside, out);
    }
    set_roughness(m, prefix, out);
    return out;
}

Material Reader::coated_conductor(const Parameters& m)
{
    const float coat_ior = ior(m, "interface.eta", 1.5f);
    Material out = conductor(m, "conductor.", coat_ior);
    Material coat;
    set_roughness(m, "interface.", coat);
    out.coat.weight = {1, -1, 0};
    out.coat.ior = coat_ior;
    out.coat.roughness = coat.roughness;
    const double thickness = layer_thickness(m);
    const auto left = float(std::exp(-2 * thickness / inner_cosine(std::sqrt(0.5), coat_ior)));
    out.coat.color = {{left, left, left}, -1};
    if (out.base_color.texture < 0) {
        const auto edge = [&](float base) { return fit_edge_tint_below_coat(base, coat_ior, thickness, left); };
        const Color& base = out.base_color.value;
        out.conductor.edge_color.value = {edge(base.r), edge(base.g), edge(base.b)};
        // base_color and edge_color account for the coat, and an exact index of refraction would override them.
        out.conductor.eta = out.conductor.k = {0, 0, 0};
    }
    if (out.roughness.texture < 0 && coat.roughness.texture < 0 && !out.microfacets.two_roughnesses)
        out.roughness.value = roughness_through_coat(out.roughness.value, coat.roughness.value, coat_ior);
    report(m, "interreflection below the coat is not simulated: its loss is computed from the color");
    return out;
}

}  // namespace fathom::pbrt
