// SPDX-License-Identifier: Apache-2.0
// Conversion of BSDFs and participating media; docs/formats.md describes it for each plugin.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/common/alpha_blend.h"
#include "formats/common/medium.h"
#include "formats/common/power.h"
#include "formats/common/suggest.h"
#include "formats/io/read_file.h"
#include "formats/mitsuba/metals.h"
#include "formats/mitsuba/reader.h"
#include "formats/mitsuba/rough_boundary.h"
#include "scene/units.h"

namespace fathom::mitsuba {

namespace {

constexpr double bk7 = 1.5046, air = 1.000277, polypropylene = 1.49, amber = 1.55;

struct NamedIor {
    const char* name;
    double ior;
};
/// Named indices from Mitsuba's documentation ("Interior and exterior IOR").
constexpr NamedIor named_iors[] = {{"vacuum", 1},        {"helium", 1.000036},        {"hydrogen", 1.000132},
                                   {"air", air},         {"carbon dioxide", 1.00045}, {"water", 1.3330},
                                   {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
                                   {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
                                   {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
                                   {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", polypropylene},
                                   {"bk7", bk7},         {"sodium chloride", 1.544},  {"amber", amber},
                                   {"pet", 1.5750},      {"diamond", 2.419}};

Color times(Color a, Color b)
{
    return {a.r * b.r, a.g * b.g, a.b * b.b};
}

float square_root(float x)
{
    return std::sqrt(std::max(0.f, x));
}

bool reflects_only(const Material& m)
{
    switch (m.kind) {
        case MaterialKind::diffuse:
        case MaterialKind::metal:
        case MaterialKind::plastic:
        case MaterialKind::measured:
            return true;
        case MaterialKind::disney:
        case MaterialKind::principled:
            return m.transmission.weight.value == 0 && m.diffuse_transmission.weight.value == 0;
        default:
            return false;
    }
}

}  // namespace

int Reader::material(const Element& bsdf)
{
    auto& known = two_sided_ ? two_sided_materials_ : materials_;
    if (const auto found = known.find(&bsdf); found != known.end()) {
        if (found->second < 0) bsdf.fail("a bsdf can't contain itself");
        return found->second;
    }
    known[&bsdf] = -1;
    Material read = read_bsdf(bsdf);
    if (read.name.empty()) read.name = bsdf.attribute("id");
    return known[&bsdf] = add_material(std::move(read));
}

int Reader::add_material(Material material)
{
    scene_.materials.push_back(std::move(material));
    return int(scene_.materials.size()) - 1;
}

Material Reader::read_bsdf(const Element& element)
{
    Object bsdf(element, document_);
    const std::string& type = bsdf.type();
    using Read = Material (Reader::*)(Object&);
    static const std::map<std::string, Read, std::less<>> readers = {{"diffuse", &Reader::diffuse},
                                                                     {"conductor", &Reader::conductor},
                                                                     {"roughconductor", &Reader::conductor},
                                                                     {"dielectric", &Reader::dielectric},
                                                                     {"roughdielectric", &Reader::dielectric},
                                                                     {"thindielectric", &Reader::thin_dielectric},
                                                                     {"plastic", &Reader::plastic},
                                                                     {"roughplastic", &Reader::plastic},
                                                                     {"pplastic", &Reader::plastic},
                                                                     {"hair", &Reader::hair},
                                                                     {"principled", &Reader::principled},
                                                                     {"principledthin", &Reader::principled},
                                                                     {"measured", &Reader::measured},
                                                                     {"mask", &Reader::mask},
                                                                     {"bumpmap", &Reader::bumps},
                                                                     {"normalmap", &Reader::bumps},
                                                                     {"blendbsdf", &Reader::blend},
                                                                     {"mixturebsdf", &Reader::mixture},
                                                                     {"phong", &Reader::phong},
                                                                     {"ward", &Reader::phong},
                                                                     {"roughdiffuse", &Reader::rough_diffuse},
                                                                     {"difftrans", &Reader::diffuse_transmitter},
                                                                     {"twosided", &Reader::two_sided}};
    Material result;
    if (type == "null") {
        result.kind = MaterialKind::none;
        result.opacity.mode = AlphaMode::blend;
        result.opacity.alpha.value = 0;
    } else if (const auto found = readers.find(type); found != readers.end()) {
        result = (this->*found->second)(bsdf);
    } else if (!bsdf.children("bsdf").empty()) {
        report(element, "is not supported: its nested bsdf is used");
        return read_nested(bsdf);
    } else {
        report(element, fmt::format("is not supported: gray diffuse is used{}", suggestion_of(type, readers)));
        result.base_color = {{0.5f, 0.5f, 0.5f}, -1};
        return result;
    }
    if (!two_sided_ && bsdf.children("bsdf").empty()) result.visibility.black_back = reflects_only(result);
    bsdf.ignore({"sample_visible", "specular_sampling_weight", "diffuse_reflectance_sampling_rate",
                 "main_specular_sampling_rate", "clearcoat_sampling_rate", "diff_trans_sampling_rate",
                 "specular_reflectance_sampling_rate"});
    bsdf.finish(context_.warnings);
    return result;
}

Material Reader::diffuse(Object& bsdf)
{
    Material m;
    m.base_color = color(bsdf, "reflectance", {0.5f, 0.5f, 0.5f});
    return m;
}

void Reader::read_roughness(Object& bsdf, Material& m)
{
    m.microfacets.beckmann = bsdf.text("distribution", "beckmann") == "beckmann";
    // Fathom's roughness is sqrt(alpha).
    const auto alpha = [&](std::string_view name, float otherwise) {
        return raise_to_power(scene_, number_or_texture(bsdf, name, otherwise), 0.5);
    };
    m.microfacets.energy_compensation = false;
    m.microfacets.separable_masking = true;
    if (bsdf.has("alpha_u") || bsdf.has("alpha_v")) {
        const FloatInput u = alpha("alpha_u", 0.1f), v = alpha("alpha_v", 0.1f);
        if (u.texture >= 0 || v.texture >= 0) {
            m.microfacets.two_roughnesses = true;
            m.microfacets.anisotropy = u, m.roughness = v;
            return;
        }
        const FloatInput& narrow = u.value < v.value ? u : v;
        const FloatInput& wide = u.value < v.value ? v : u;
        const float narrow_alpha = narrow.value * narrow.value, wide_alpha = wide.value * wide.value;
        m.roughness = narrow;
        if (wide_alpha > narrow_alpha)
            m.microfacets.anisotropy = {square_root((wide_alpha - narrow_alpha) / (1 - narrow_alpha)), -1, 0};
        if (u.value < v.value) m.microfacets.anisotropy_rotation = 1.5707963267948966;
        return;
    }
    m.roughness = alpha("alpha", 0.1f);
}

Material Reader::mirror()
{
    Material m;
    m.kind = MaterialKind::principled;
    m.metallic = {1, -1, 0};
    m.microfacets.energy_compensation = false;
    m.roughness = {0, -1, 0};
    m.base_color = m.conductor.edge_color = {{1, 1, 1}, -1};
    return m;
}

void Reader::tint(Material& mirror, const ColorInput& color)
{
    // A coat of index 1 doesn't reflect and only tints the layers below.
    mirror.coat.weight = {1, -1, 0};
    mirror.coat.ior = 1;
    mirror.coat.darkening = 0;
    mirror.coat.color = color;
}

Material Reader::conductor(Object& bsdf)
{
    Material m = mirror();
    ConductorColors colors{{1, 1, 1}, {1, 1, 1}};
    const auto take = [&](const Conductor& conductor) {
        colors = colors_of(conductor);
        m.conductor.eta = conductor.eta, m.conductor.k = conductor.k;
    };
    const std::string name = bsdf.text("material", "none");
    if (bsdf.has("eta") || bsdf.has("k")) {
        const Conductor conductor{"", plain_color(bsdf, "eta", {0, 0, 0}), plain_color(bsdf, "k", {1, 1, 1})};
        take(within(conductor, float(ior(bsdf, "ext_eta", 1))));
    } else if (name != "none") {
        const auto metal =
            std::find_if(std::begin(metals), std::end(metals), [&](const Conductor& c) { return name == c.name; });
        if (metal != std::end(metals))
            take(*metal);
        else
            report(bsdf.element(), fmt::format("the metal '{}' is unknown: a perfect mirror is used", printable(name)));
    }
    m.base_color = {colors.base, -1}, m.conductor.edge_color = {colors.edge, -1};
    if (bsdf.has("specular_reflectance")) tint(m, color(bsdf, "specular_reflectance", {1, 1, 1}));
    if (bsdf.type() == "roughconductor") read_roughness(bsdf, m);
    return m;
}

double Reader::ior(Object& bsdf, std::string_view name, double otherwise)
{
    const Element* const found = bsdf.child(name);
    if (!found) return otherwise;
    if (found->tag != "string") return bsdf.number(name, otherwise);
    const std::string text = bsdf.text(name, "");
    std::vector<std::string> names;
    for (const NamedIor& n : named_iors) {
        if (text == n.name) return n.ior;
        names.emplace_back(n.name);
    }
    found->fail(fmt::format("the index of refraction of '{}' is unknown{}", printable(text), suggestion(text, names)));
}

double Reader::relative_ior(Object& bsdf, double inside, double outside)
{
    const double relative = ior(bsdf, "int_ior", inside) / ior(bsdf, "ext_ior", outside);
    if (!(relative > 0) || !std::isfinite(relative)) bsdf.element().fail("indices of refraction must be above 0");
    return relative;
}

Material Reader::dielectric(Object& bsdf)
{
    Material m;
    m.kind = MaterialKind::glass;
    m.ior = float(relative_ior(bsdf, bk7, air));
    m.roughness = {0, -1, 0};
    m.base_color = {{1, 1, 1}, -1};
    m.microfacets.energy_compensation = false;
    if (bsdf.type() == "roughdielectric") {
        read_roughness(bsdf, m);
        if (m.microfacets.two_roughnesses || m.microfacets.anisotropy.value > 0)
            report(
                bsdf.element(),
                "anisotropic roughness of glass is not supported: the roughness along v, or the smaller one, is used");
        m.microfacets.two_roughnesses = false, m.microfacets.anisotropy = {0, -1, 0};
    }
    // Mitsuba applies the transmittance at each crossing of the boundary, Fathom's color to the pair of entry and exit.
    m.transmission.color = squared(color(bsdf, "specular_transmittance", {1, 1, 1}));
    m.specular.color = color(bsdf, "specular_reflectance", {1, 1, 1});
    return m;
}

ColorInput Reader::squared(const ColorInput& color)
{
    if (color.texture < 0) return {times(color.value, color.value), -1};
    Texture square;
    square.kind = TextureKind::scale;
    square.color_a = square.color_b = color;
    return {{1, 1, 1}, add_texture(scene_, std::move(square))};
}

Material Reader::thin_dielectric(Object& bsdf)
{
    Material m = dielectric(bsdf);
    m.interior.thin = true;
    m.transmission.color = color(bsdf, "specular_transmittance", {1, 1, 1});
    return m;
}

Material Reader::plastic(Object& bsdf)
{
    Material m;
    m.kind = MaterialKind::plastic;
    m.base_color = color(bsdf, "diffuse_reflectance", {0.5f, 0.5f, 0.5f});
    m.ior = float(relative_ior(bsdf, polypropylene, air));
    m.plastic.nonlinear = bsdf.boolean("nonlinear", false);
    m.roughness = {0, -1, 0};
    if (bsdf.type() == "roughplastic") {
        read_roughness(bsdf, m);
        if (m.roughness.texture < 0) {
            const double alpha = std::max(1e-4, double(m.roughness.value) * double(m.roughness.value));
            m.plastic.inner_reflectance =
                float(std::min(0.9999, inner_reflectance(alpha, m.microfacets.beckmann, double(m.ior))));
        }
    }
    m.microfacets.two_roughnesses = false, m.microfacets.anisotropy = {0, -1, 0};
    m.specular.color = color(bsdf, "specular_reflectance", {1, 1, 1});
    return m;
}

Material Reader::hair(Object& bsdf)
{
    Material m;
    m.kind = MaterialKind::hair;
    m.hair.beta_m = {float(bsdf.number("longitudinal_roughness", 0.3)), -1, 1};
    m.hair.beta_n = {float(bsdf.number("azimuthal_roughness", 0.3)), -1, 1};
    m.hair.scale_tilt = bsdf.number("scale_tilt", 2) * radians_per_degree;
    m.hair.ior = float(std::clamp(relative_ior(bsdf, amber, air), 1.0, 3.0));
    // With base color 1, only the absorption set below tints the hair.
    m.base_color = {{1, 1, 1}, -1};
    if (bsdf.has("sigma_a")) {
        const float scale = float(bsdf.number("scale", 1));
        const std::optional<Color> plain = color_of(*bsdf.child("sigma_a"));  // plain values, which may exceed 1
        m.hair.absorption = plain ? ColorInput{*plain, -1} : color(bsdf, "sigma_a", {0, 0, 0});
        for (float* c : {&m.hair.absorption.value.r, &m.hair.absorption.value.g, &m.hair.absorption.value.b})
            *c *= scale;
    } else {
        m.hair.eumelanin = float(bsdf.number("eumelanin", 1.3));
        m.hair.pheomelanin = float(bsdf.number("pheomelanin", 0.2));
    }
    bsdf.ignore({"scale", "eumelanin", "pheomelanin"});
    return m;
}

Material Reader::principled(Object& bsdf)
{
    Material m;
    m.kind = MaterialKind::disney;
    m.interior.thin = bsdf.type() == "principledthin";
    m.base_color = color(bsdf, "base_color", {0.5f, 0.5f, 0.5f});
    m.roughness = number_or_texture(bsdf, "roughness", 0.5f);
    m.metallic = number_or_texture(bsdf, "metallic", 0);
    m.transmission.weight = number_or_texture(bsdf, "spec_trans", 0);
    double ior = 1.5;
    if (bsdf.has("eta")) {
        const FloatInput eta = number_or_texture(bsdf, "eta", 1.5f);
        if (eta.texture >= 0)
            report(bsdf.element(), "a texture as 'eta' is not supported: 1.5 is used");
        else
            ior = double(eta.value);
    } else {
        // The principled BSDF's specular is the reflectance at normal incidence over 0.08.
        const double root = std::sqrt(std::clamp(0.08 * bsdf.number("specular", 0.5), 0.0, 0.99));
        ior = (1 + root) / (1 - root);
    }
    m.ior = float(ior);
    m.microfacets.anisotropy = number_or_texture(bsdf, "anisotropic", 0);
    m.coat.weight = number_or_texture(bsdf, "clearcoat", 0);
    m.disney.coat_gloss = number_or_texture(bsdf, "clearcoat_gloss", 0);
    m.disney.sheen = number_or_texture(bsdf, "sheen", 0);
    m.disney.sheen_tint = number_or_texture(bsdf, "sheen_tint", 0);
    m.disney.flatness = number_or_texture(bsdf, "flatness", 0);
    m.disney.specular_tint = number_or_texture(bsdf, "spec_tint", 0);
    m.diffuse_transmission.weight = number_or_texture(bsdf, "diff_trans", 0);
    m.diffuse_transmission.weight.value *= 0.5f;
    bsdf.ignore({"specular"});
    return m;
}

Material Reader::measured(Object& bsdf)
{
    const std::string filename = bsdf.text("filename", "");
    if (filename.empty()) bsdf.element().fail(fmt::format("{} needs a 'filename'", bsdf.title()));
    Material m;
    m.kind = MaterialKind::measured;
    m.measured = measured_files_.index_of(document_.locate(filename, context_));
    return m;
}

Material Reader::mask(Object& bsdf)
{
    Material m = read_nested(bsdf);
    const FloatInput opacity = number_or_texture(bsdf, "opacity", 0.5f);
    if (is_null_interface(m)) return m;
    m.opacity.alpha = m.opacity.mode == AlphaMode::opaque ? opacity : product(scene_, m.opacity.alpha, opacity);
    m.opacity.mode = AlphaMode::blend;
    return m;
}

void Reader::read_interior(const Element& element, Material& m)
{
    Object medium(element, document_);
    if (medium.type() != "homogeneous") {
        report(element, fmt::format("the medium '{}' is not supported: it is ignored", printable(medium.type())));
        return;
    }
    const double scale = medium.number("scale", 1);
    const Color extinction = plain_color(medium, "sigma_t", {1, 1, 1}),
                albedo = plain_color(medium, "albedo", {0.75f, 0.75f, 0.75f});
    float anisotropy = 0;
    for (const Element* phase_element : medium.children("phase")) {
        Object phase(*phase_element, document_);
        if (phase.type() == "hg") anisotropy = float(phase.number("g", 0.8));
        phase.finish(context_.warnings);
    }
    medium.ignore({"sample_emitters", "has_spectral_extinction"});
    medium.finish(context_.warnings);
    if (!(scale > 0)) return;
    if (is_null_interface(m)) m = index_matched_boundary();
    if (m.kind != MaterialKind::glass) return report(element, "is supported inside glass only: it is ignored");
    m.interior.scatter_bounces = true;
    const auto absorbed = [&](float t, float a) { return float(double(t) * scale * (1 - a)); };
    const auto scattered = [&](float t, float a) { return float(double(t) * scale * a); };
    fill_solid(
        m, {absorbed(extinction.r, albedo.r), absorbed(extinction.g, albedo.g), absorbed(extinction.b, albedo.b)},
        {scattered(extinction.r, albedo.r), scattered(extinction.g, albedo.g), scattered(extinction.b, albedo.b)},
        anisotropy);
}

/// Fills the space outside all shapes with the camera's medium, if it has one.
void Reader::finish_media()
{
    for (const Element* medium : media_of_shapes_.not_enclosed(camera_medium_))
        report(*medium, medium_not_enclosed_message);
    if (!camera_medium_) return;
    Material m = index_matched_boundary();
    read_interior(*camera_medium_, m);
    if (!(m.interior.attenuation_distance > 0)) return;
    if (const std::string told = add_surrounding_medium(scene_, std::move(m)); !told.empty())
        report(*camera_medium_, told);
}

int Reader::material_of_shape(Object& shape)
{
    const std::vector<const Element*> bsdfs = shape.children("bsdf"), emitters = shape.children("emitter");
    const Element* const medium = shape.child("interior");
    media_of_shapes_.add(medium, shape.child("exterior"));
    const Element* const bsdf = bsdfs.empty() ? nullptr : bsdfs.back();
    const Element* const emitter = emitters.empty() ? nullptr : emitters.front();
    if (bsdf && !emitter && !medium) return material(*bsdf);
    const auto [found, is_new] = shape_materials_.emplace(std::array<const Element*, 3>{bsdf, emitter, medium}, 0);
    if (!is_new) return found->second;
    Material m;
    const float gray = emitter ? 0.f : 0.5f;
    m.base_color = {{gray, gray, gray}, -1};
    m.visibility.black_back = true;
    if (bsdf) m = scene_.materials[std::size_t(material(*bsdf))];
    if (medium) read_interior(*medium, m);
    if (emitter && emitter->type() != "directionalarea") {
        Object area(*emitter, document_);
        if (area.type() != "area")
            report(*emitter,
                   fmt::format("the emitter '{}' of a shape is not supported: 'area' is used", printable(area.type())));
        m = with_emission(std::move(m), color(area, "radiance", {1, 1, 1}));
        area.ignore({"sampling_weight"});
        area.finish(context_.warnings);
    }
    found->second = add_material(std::move(m));
    if (emitter) emissive_materials_.push_back(found->second);
    return found->second;
}

}  // namespace fathom::mitsuba
