// SPDX-License-Identifier: Apache-2.0
// Conversion of materials and participating media; docs/formats.md describes it for each plugin.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/common/alpha_blend.h"
#include "formats/common/lights.h"
#include "formats/common/medium.h"
#include "formats/common/power.h"
#include "formats/common/suggest.h"
#include "formats/io/read_file.h"
#include "formats/pbrt/reader.h"
#include "scene/units.h"

namespace fathom::pbrt {

namespace {

float largest(const ColorInput& c)
{
    return std::max({c.value.r, c.value.g, c.value.b});
}

/// Whether two reflectances sum to more than 1. Values of textures are unknown here.
bool is_above_1(const ColorInput& a, const ColorInput& b)
{
    constexpr float most = 1 + 1e-5f;
    if (a.texture >= 0 || b.texture >= 0) return false;
    return a.value.r + b.value.r > most || a.value.g + b.value.g > most || a.value.b + b.value.b > most;
}

}  // namespace

Material Reader::material(const Parameters* plugin)
{
    if (!plugin) {
        Material gray;
        gray.base_color = {{0.5f, 0.5f, 0.5f}, -1};
        return gray;
    }
    if (const auto found = materials_.find(plugin); found != materials_.end()) return found->second;
    if (!open_materials_.insert(plugin).second) plugin->fail("a material can't contain itself");
    Material read = read_material(*plugin);
    open_materials_.erase(plugin);
    return materials_[plugin] = std::move(read);
}

Material Reader::read_material(const Parameters& m)
{
    const std::string& type = m.plugin();
    Material result;
    if (type == "interface" || type.empty() || type == "none") {
        result.kind = MaterialKind::none;
        result.opacity.mode = AlphaMode::blend;
        result.opacity.alpha.value = 0;
        m.finish(reporter_);
        return result;
    }
    if (type == "diffuse")
        result = diffuse(m);
    else if (type == "coateddiffuse")
        result = coated_diffuse(m);
    else if (type == "conductor")
        result = conductor(m, "", 1);
    else if (type == "coatedconductor")
        result = coated_conductor(m);
    else if (type == "dielectric" || type == "thindielectric")
        result = dielectric(m, 1.5f);
    else if (type == "diffusetransmission")
        result = diffuse_transmission(m);
    else if (type == "subsurface")
        result = subsurface(m);
    else if (type == "hair")
        result = hair(m);
    else if (type == "measured")
        result = measured(m);
    else if (type == "mix")
        result = mix(m);
    else {
        const std::vector<std::string> names = {"diffuse",
                                                "coateddiffuse",
                                                "conductor",
                                                "coatedconductor",
                                                "dielectric",
                                                "thindielectric",
                                                "diffusetransmission",
                                                "subsurface",
                                                "hair",
                                                "mix",
                                                "interface",
                                                "measured"};
        report(m, fmt::format("is not supported: gray diffuse is used{}", suggestion(type, names)));
        result.base_color = {{0.5f, 0.5f, 0.5f}, -1};
        return result;
    }
    if (type != "mix") set_bumps(m, result);
    m.ignore({"type"});
    m.finish(reporter_);
    return result;
}

Material Reader::diffuse(const Parameters& m)
{
    Material out;
    out.base_color = color(m, "reflectance", {0.5f, 0.5f, 0.5f});
    return out;
}

/// Fathom's alpha is roughness^2. pbrt's alpha is the roughness, or its square root with remapping.
FloatInput Reader::roughness(const Parameters& m, const std::string& name, float otherwise, bool remap)
{
    return raise_to_power(scene_, number_or_texture(m, name, otherwise), remap ? 0.25 : 0.5);
}

void Reader::set_roughness(const Parameters& m, const std::string& prefix, Material& out)
{
    const bool remap = m.boolean("remaproughness", true);
    const FloatInput both = roughness(m, prefix + "roughness", 0, remap);
    const auto of = [&](const std::string& name) { return m.has(name) ? roughness(m, name, 0, remap) : both; };
    const FloatInput u = of(prefix + "uroughness"), v = of(prefix + "vroughness");
    out.microfacets.energy_compensation = false;
    out.roughness = u;
    if (u.texture >= 0 || v.texture >= 0) {
        if (!m.has(prefix + "uroughness") && !m.has(prefix + "vroughness")) return;
        out.microfacets.two_roughnesses = true;
        out.microfacets.anisotropy = u, out.roughness = v;
        return;
    }
    const float narrow = std::min(u.value, v.value), wide = std::max(u.value, v.value);
    out.roughness.value = narrow;
    const float narrow_alpha = narrow * narrow, wide_alpha = wide * wide;
    if (wide_alpha > narrow_alpha)
        out.microfacets.anisotropy = {std::sqrt((wide_alpha - narrow_alpha) / (1 - narrow_alpha)), -1, 0};
    if (u.value < v.value) out.microfacets.anisotropy_rotation = 1.5707963267948966;
}

/// Reads a normal map or, failing that, a bump map.
void Reader::set_bumps(const Parameters& m, Material& out)
{
    const std::string file = m.text("normalmap", "");
    Texture map;
    if (file.empty()) {
        if (m.has("displacement")) out.bump = number_or_texture(m, "displacement", 0);
    } else {
        m.ignore({"displacement"});
        const std::filesystem::path path = locate(m, file);
        const auto [found, is_new] = images_.emplace(path.string(), int(scene_.images.size()));
        if (is_new) scene_.images.push_back({file, path, {}});
        map.name = file;
        map.image = found->second;
        map.color_space = ColorSpace::linear;
        out.normal_map.texture = add_texture(map);
        out.map_tangents = false;
    }
}

/// Approximates pbrt's stochastic layering, which loses light that facets scatter to the wrong side.
Material Reader::coated_diffuse(const Parameters& m)
{
    Material out;
    out.kind = MaterialKind::plastic;
    out.base_color = color(m, "reflectance", {0.5f, 0.5f, 0.5f});
    set_roughness(m, "", out);
    out.ior = ior(m, "eta", 1.5f);
    if (out.microfacets.anisotropy.value > 0)
        report(m, "anisotropic roughness of the coat is not supported: isotropic roughness is used");
    out.microfacets.two_roughnesses = false, out.microfacets.anisotropy = {0, -1, 0};
    out.plastic.optical_thickness = layer_thickness(m);
    return out;
}

/// Optical thickness between the layers; the coefficient is 1, so the layer absorbs even without an albedo.
float Reader::layer_thickness(const Parameters& m)
{
    const FloatInput thickness = number_or_texture(m, "thickness", 0.01f);
    if (thickness.texture >= 0) report(m, "a texture as 'thickness' is not supported: only its scale is used");
    const float scattered = m.has("albedo") ? largest(color(m, "albedo", {0, 0, 0})) : 0;
    if (scattered > 0)
        report(m, "scattering between the layers is not supported: light that would scatter is transmitted");
    m.ignore({"maxdepth", "nsamples", "g", "albedo"});
    return std::clamp(thickness.value * (1 - scattered), 0.f, 100.f);
}

Material Reader::dielectric(const Parameters& m, float usual_index)
{
    Material out;
    out.kind = MaterialKind::glass;
    out.base_color = {{1, 1, 1}, -1};
    const GlassIndex glass = glass_index(m, "eta", usual_index);
    out.ior = float(glass.middle);
    out.interior.thin = m.plugin() == "thindielectric";
    out.roughness = {0, -1, 0};
    out.microfacets.energy_compensation = false;
    // Dispersion is invisible in thin panes.
    if (out.interior.thin) return out;
    if (glass.abbe > 0) {
        // A principled material with these values equals glass bit for bit, apart from dispersion.
        out.kind = MaterialKind::principled;
        out.metallic = {0, -1, 0};
        out.transmission.weight = {1, -1, 0};
        out.transmission.dispersion = float(std::min(20 / glass.abbe, 40.0));
    }
    set_roughness(m, "", out);
    if (out.microfacets.anisotropy.value > 0)
        report(m, "anisotropic roughness of glass is not supported: isotropic roughness is used");
    out.microfacets.two_roughnesses = false, out.microfacets.anisotropy = {0, -1, 0};
    return out;
}

Material Reader::diffuse_transmission(const Parameters& m)
{
    const double scale = m.number("scale", 1);
    const auto limited = [&](ColorInput c) {
        c.value = scaled(c.value, scale);
        for (float* channel : {&c.value.r, &c.value.g, &c.value.b}) *channel = std::min(*channel, 1.f);
        return c;
    };
    Material out;
    out.kind = MaterialKind::principled;
    out.metallic = {0, -1, 0};
    out.specular.weight = {0, -1, 0};
    out.roughness = {1, -1, 0};
    out.base_color = limited(color(m, "reflectance", {0.25f, 0.25f, 0.25f}));
    out.diffuse_transmission.weight = {1, -1, 0};
    out.diffuse_transmission.color = limited(color(m, "transmittance", {0.25f, 0.25f, 0.25f}));
    out.diffuse_transmission.added = true;
    if (is_above_1(out.base_color, out.diffuse_transmission.color))
        report(m, "reflects and transmits more light than it receives, as in pbrt");
    return out;
}

/// The measured medium named by a parameter; null if the parameter is missing.
const MeasuredMedium* Reader::measured_medium(const Parameters& of, std::string_view parameter)
{
    const std::string name = of.text(parameter, "");
    if (name.empty()) return nullptr;
    const MeasuredMedium* const found = find_medium(name);
    if (!found) of.fail(fmt::format("there is no medium '{}'{}", printable(name), suggestion(name, medium_names())));
    return found;
}

Material Reader::subsurface(const Parameters& m)
{
    Material out = dielectric(m, 1.33f);
    const double scale = m.number("scale", 1);
    const auto g = float(m.number("g", 0));
    if (m.has("reflectance")) {
        out = Material();
        out.kind = MaterialKind::principled;
        out.ior = ior(m, "eta", 1.33f);
        out.metallic = {0, -1, 0};
        set_roughness(m, "", out);
        out.subsurface.weight = {1, -1, 0};
        out.subsurface.color = color(m, "reflectance", {0.5f, 0.5f, 0.5f});
        const Color path = color_value(m, "mfp", {1, 1, 1}, true);
        const float longest = std::max({path.r, path.g, path.b, 1e-6f});
        out.subsurface.radius = {longest * float(scale), -1, 0};
        out.subsurface.radius_scale = {scaled(path, 1 / longest), -1};
        out.subsurface.scatter_anisotropy = g;
        return out;
    }
    if (const MeasuredMedium* const known = measured_medium(m, "name")) {
        m.ignore({"sigma_a", "sigma_s", "g"});
        fill_solid(out, scaled(known->absorption, scale), scaled(known->scattering, scale), 0);
        return out;
    }
    for (const char* texture : {"sigma_a", "sigma_s"})
        if (m.has(texture) && m.find(texture)->type == "texture")
            m.fail(fmt::format("a texture as '{}' is not supported: use a color", texture));
    fill_solid(out, scaled(color_value(m, "sigma_a", {0.0011f, 0.0024f, 0.014f}, true), scale),
               scaled(color_value(m, "sigma_s", {2.55f, 3.21f, 3.77f}, true), scale), g);
    return out;
}

/// The first of 'sigma_a', 'reflectance' (formerly 'color') and the melanins that is present applies.
Material Reader::hair(const Parameters& m)
{
    Material out;
    out.kind = MaterialKind::hair;
    out.hair.beta_m = number_or_texture(m, "beta_m", 0.3f);
    out.hair.beta_n = number_or_texture(m, "beta_n", 0.3f);
    out.hair.scale_tilt = number_or_texture(m, "alpha", 2).value * radians_per_degree;
    out.hair.ior = std::clamp(ior(m, "eta", 1.55f), 1.f, 3.f);
    // With base color 1, only the absorption set below tints the hair.
    out.base_color = {{1, 1, 1}, -1};
    if (m.has("sigma_a")) {
        out.hair.absorption = m.find("sigma_a")->type == "texture"
                                  ? color(m, "sigma_a", {0, 0, 0})
                                  : ColorInput{color_value(m, "sigma_a", {0, 0, 0}, true), -1};
    } else if (m.has("reflectance") || m.has("color")) {
        out.base_color = color(m, m.has("reflectance") ? "reflectance" : "color", {0.5f, 0.5f, 0.5f});
    } else {
        const bool is_said = m.has("eumelanin") || m.has("pheomelanin");
        const FloatInput e = number_or_texture(m, "eumelanin", is_said ? 0 : 1.3f),
                         p = number_or_texture(m, "pheomelanin", 0);
        out.hair.eumelanin = e.value, out.hair.pheomelanin = p.value;
        if (e.texture >= 0 || p.texture >= 0)
            report(m, "textures of melanin concentrations are not supported: only their scale is used");
    }
    m.ignore({"sigma_a", "reflectance", "color", "eumelanin", "pheomelanin"});
    return out;
}

Material Reader::measured(const Parameters& m)
{
    const std::string file = m.text("filename", "");
    if (file.empty()) m.fail("it needs a 'filename'");
    Material out;
    out.kind = MaterialKind::measured;
    out.measured = measured_files_.index_of(locate(m, file));
    return out;
}

Material Reader::mix(const Parameters& m)
{
    const std::vector<std::string> names = m.texts("materials");
    if (names.size() != 2) m.fail("'materials' must be the names of two materials");
    Material both[2];
    for (std::size_t i = 0; i < 2; ++i) {
        const auto found = named_materials_.find(names[i]);
        if (found == named_materials_.end()) m.fail(fmt::format("there is no material '{}'", printable(names[i])));
        both[i] = material(found->second.get());
    }
    const FloatInput amount = number_or_texture(m, "amount", 0.5f);
    if (amount.texture < 0 && (amount.value <= 0 || amount.value >= 1)) return both[amount.value >= 1 ? 1 : 0];
    for (const bool second : {false, true})
        if (is_null_interface(both[second])) return blend_with_transparent(scene_, both[!second], amount, second);
    const auto is_plain = [](const Material& part) {
        return part.kind == MaterialKind::diffuse && part.opacity.mode == AlphaMode::opaque &&
               part.normal_map.texture < 0 && part.bump.texture < 0;
    };
    if (is_plain(both[0]) && is_plain(both[1])) {
        both[0].base_color = mixed(both[0].base_color, both[1].base_color, amount);
        return both[0];
    }
    Material out;
    out.kind = MaterialKind::mix;
    out.mixture.factor = amount;
    out.mixture.material_a = int(scene_.materials.size()), out.mixture.material_b = out.mixture.material_a + 1;
    for (std::size_t i = 0; i < 2; ++i) {
        if (both[i].opacity.mode != AlphaMode::opaque) report(m, "an 'interface' in a mix within a mix is black");
        both[i].name = names[i];
        scene_.materials.push_back(both[i]);
    }
    return out;
}

void Reader::set_medium(const Parameters& medium, Material& out)
{
    const std::string& type = medium.plugin();
    if (type != "homogeneous") {
        report(medium, "is not supported: it is ignored");
        return;
    }
    if (medium.has("Le")) report(medium, "emissive media are not supported: 'Le' is ignored");
    const double scale = medium.number("scale", 1);
    const MeasuredMedium* const known = measured_medium(medium, "preset");
    // Defaults of pbrt's code, which differ from its manual.
    const Color absorption = known ? known->absorption : color_value(medium, "sigma_a", {1, 1, 1}, true),
                scattering = known ? known->scattering : color_value(medium, "sigma_s", {1, 1, 1}, true);
    if (known) medium.ignore({"sigma_a", "sigma_s"});
    const auto g = float(medium.number("g", 0));
    medium.ignore({"type", "Le", "Lescale"});
    medium.finish(reporter_);
    if (out.kind == MaterialKind::none) out = index_matched_boundary();
    if (out.kind != MaterialKind::glass &&
        !(out.kind == MaterialKind::principled && out.transmission.weight.value == 1)) {
        report(medium, "is supported inside glass only: it is ignored");
        return;
    }
    out.interior.scatter_bounces = true;
    fill_solid(out, scaled(absorption, scale), scaled(scattering, scale), g);
}

/// Fills the space outside all shapes with the camera's medium, if it has one.
void Reader::finish_media()
{
    const Parameters* around = nullptr;
    if (!camera_medium_.empty()) around = medium(camera_->place(), camera_medium_);
    for (const Parameters* medium : media_of_shapes_.not_enclosed(around)) report(*medium, medium_not_enclosed_message);
    if (!around) return;
    Material m = index_matched_boundary();
    set_medium(*around, m);
    if (!(m.interior.attenuation_distance > 0)) return;
    if (const std::string told = add_surrounding_medium(scene_, std::move(m)); !told.empty()) report(*around, told);
}

void Reader::set_emission(const Surface& surface, Material& out)
{
    const Parameters& light = *surface.light;
    if (light.plugin() != "diffuse") report(light, "is not supported: 'diffuse' is used");
    ColorInput emission{light_color(light, "L"), -1};
    if (light.has("filename")) {
        Texture picture;
        picture.name = light.text("filename", "");
        picture.image = image(light);
        emission.texture = add_texture(picture);
    }
    emission.value = scaled(emission.value, surface.power_factor);
    out.emission.radiance = emission;
    out.emission.two_sided = light.boolean("twosided", false);
    light.ignore({"power"});
    light.finish(reporter_);
    if (out.kind == MaterialKind::none && out.opacity.mode == AlphaMode::blend && out.opacity.alpha.value == 0) {
        out.opacity.alpha.value = 1;
        out.opacity.mode = AlphaMode::opaque;
    }
}

int Reader::surface_material(const Surface& surface)
{
    if (const auto found = surfaces_.find(surface); found != surfaces_.end()) return found->second;
    Material m = material(surface.material);
    if (surface.medium) set_medium(*surface.medium, m);
    if (surface.is_vacuum_interior && m.kind == MaterialKind::none) m = index_matched_boundary();
    if (surface.light) set_emission(surface, m);
    scene_.materials.push_back(std::move(m));
    return surfaces_[surface] = int(scene_.materials.size()) - 1;
}

const Parameters* Reader::state_material(const Place& place)
{
    if (state_.named_material.empty()) return state_.material.get();
    const auto found = named_materials_.find(state_.named_material);
    if (found != named_materials_.end()) return found->second.get();
    place.fail(fmt::format("there is no material '{}'{}", printable(state_.named_material),
                           suggestion_of(state_.named_material, named_materials_)));
}

}  // namespace fathom::pbrt
