// Conductors: what their indices of refraction make of light.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "import/common/read_file.h"
#include "import/pbrt/named_spectra.h"
#include "import/pbrt/reader.h"
#include "scene/conductors.h"

namespace fathom::pbrt {

namespace {

/// Fresnel's reflectance over the wavelengths, as a colour in daylight.
Color reflectance(const std::vector<SpectrumPoint>& eta, const std::vector<SpectrumPoint>& k, double outside,
                  double cosine)
{
    std::vector<SpectrumPoint> points;
    for (double nm = 360; nm <= 830; nm += 5)
        points.push_back({nm, conductor_reflectance(cosine, value_at(eta, nm) / outside, value_at(k, nm) / outside)});
    return color_of_surface(points);
}

float edge_channel(float at_normal, float at_edge)
{
    const double schlick = at_normal + (1 - at_normal) * std::pow(6.0 / 7, 5);
    return float(std::clamp(at_edge / schlick, 0.0, 1.0));
}

}  // namespace

void Reader::set_metal_colors(const Parameters& m, const std::string& prefix, float outside, Material& out)
{
    const auto set = [&](const ConductorColors& colors) {
        out.base_color = {colors.base, -1}, out.edge_color = {colors.edge, -1};
    };
    const Parameter *const eta = m.find(prefix + "eta"), *const k = m.find(prefix + "k");
    const auto name = [](const Parameter* p) { return p && p->strings.size() == 1 ? p->strings[0] : std::string(); };
    const auto is_plain = [](const Parameter* p) { return p && (p->type == "rgb" || p->type == "float"); };
    if (is_plain(eta) && is_plain(k)) {
        Conductor plain{"", color_value(m, *eta, true), color_value(m, *k, true)};
        for (Color* c : {&plain.eta, &plain.k}) *c = {c->r / outside, c->g / outside, c->b / outside};
        return set(colors_of(plain));
    }
    // Pairs of wavelength and value, here or in a file.
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
        return set({base, {edge_channel(base.r, edge.r), edge_channel(base.g, edge.g), edge_channel(base.b, edge.b)}});
    }
    const std::string spectrum = eta ? name(eta) : "metal-Cu-eta";
    const std::string metal = metal_of(spectrum);
    for (const Conductor& c : conductors())
        if (metal == c.name) {
            Conductor in_coat = c;
            for (Color* v : {&in_coat.eta, &in_coat.k}) *v = {v->r / outside, v->g / outside, v->b / outside};
            return set(colors_of(in_coat));
        }
    tell(m, fmt::format("the metal '{}' is not known: aluminium instead", printable(spectrum)));
    for (const Conductor& c : conductors())
        if (std::string_view(c.name) == "aluminium") set(colors_of(c));
}

Material Reader::conductor(const Parameters& m, const std::string& prefix, float outside)
{
    Material out;
    out.kind = MaterialKind::principled;
    out.metallic = {1, -1, 0};
    if (m.has("reflectance")) {
        // What pbrt makes of it, eta 1 and a k, is Schlick's law nearly.
        out.base_color = color(m, "reflectance", {0.5f, 0.5f, 0.5f});
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
    out.coat = {1, -1, 0};
    out.coat_ior = coat_ior;
    out.coat_roughness = coat.roughness;
    tell(m, "light below the coat is not followed: what it loses there is computed from the colour");
    m.ignore({"thickness", "maxdepth", "nsamples", "g", "albedo"});
    return out;
}

}  // namespace fathom::pbrt
