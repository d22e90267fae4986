// SPDX-License-Identifier: Apache-2.0
#include "formats/gltf/glb_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "formats/gltf/texture_channel.h"
#include "formats/io/read_file.h"
#include "scene/measured.h"

namespace fathom {

namespace {

using namespace texture_channel;

Json color_factor(Color c)
{
    return {number_json(c.r), number_json(c.g), number_json(c.b)};
}

bool is_gray(Color c, float value)
{
    return c.r == value && c.g == value && c.b == value;
}

}  // namespace

GlbMaterials::GlbMaterials(const SceneDescription& scene, GlbBuffer& buffer, const std::string& file,
                           Warnings& warnings)
    : scene_(scene), buffer_(buffer), file_(file), warnings_(warnings)
{
}

int GlbMaterials::index(int material)
{
    const auto [found, is_new] = indices_.try_emplace(material, int(materials_.size()));
    if (is_new) materials_.push_back(material_json(material < 0 ? Material() : dominant_material(material)));
    return found->second;
}

Material GlbMaterials::dominant_material(int material)
{
    const Material& m = scene_.materials[std::size_t(material)];
    if (m.kind != MaterialKind::mix && m.kind != MaterialKind::two_sided) return m;
    const float factor =
        m.kind == MaterialKind::mix
            ? (m.mixture.factor.texture < 0 ? 1 : mean_of(m.mixture.factor.texture).g) * m.mixture.factor.value
            : 0;
    Material part = dominant_material(factor > 0.5f ? m.mixture.material_b : m.mixture.material_a);
    current_ = &m;
    report(m.kind == MaterialKind::mix ? "a mix of materials: the one with the larger share is written"
                                       : "a different material on the back: the front's material is used");
    part.name = m.name;
    part.emission.radiance = m.emission.radiance, part.emission.two_sided = m.emission.two_sided;
    part.opacity.mode = m.opacity.mode, part.opacity.alpha = m.opacity.alpha, part.opacity.cutoff = m.opacity.cutoff;
    return part;
}

void GlbMaterials::put_into(Json& gltf) const
{
    const auto put = [&](const char* key, const Json& list) {
        if (!list.empty()) gltf[key] = list;
    };
    put("materials", materials_);
    put("textures", texture_list_);
    put("images", image_list_);
    put("samplers", sampler_list_);
}

void GlbMaterials::report(const std::string& what)
{
    const std::string& name = current_->name;
    warnings_.add(fmt::format("{}: {}: glTF can't express {}", file_,
                              name.empty() ? "a material" : fmt::format("material '{}'", printable(name)), what));
}

Json& GlbMaterials::extension(Json& json, const char* name)
{
    extensions_.insert(name);
    Json& made = json["extensions"][name];
    if (made.is_null()) made = Json::object();
    return made;
}

void GlbMaterials::put_factor(Json& json, const char* key, const FloatInput& input, float usual,
                              const char* texture_key, int channel)
{
    float value = input.value;
    Json info;
    if (input.texture >= 0 && is_picture(input.texture)) {
        if (input.channel == channel)
            info = texture_info(input.texture, ColorSpace::linear);
        else
            report(fmt::format("'{}' from another channel of its image", key));
    } else if (input.texture >= 0) {
        const Color mean = mean_of(input.texture);
        const float channels[] = {mean.r, mean.g, mean.b, 1, 0.2126f * mean.r + 0.7152f * mean.g + 0.0722f * mean.b};
        static_assert(std::size(channels) == luminance_channel + 1);
        value *= channels[input.channel];
        texture_info(input.texture, ColorSpace::linear);  // reports the texture
    }
    if (value != usual) json[key] = number_json(value);
    if (!info.is_null()) json[texture_key] = std::move(info);
}

void GlbMaterials::put_color(Json& json, const char* key, const ColorInput& input, Color usual, const char* texture_key)
{
    Color value = input.value;
    Json info = texture_info(input.texture, ColorSpace::srgb);
    if (info.is_null()) {
        const Color mean = mean_of(input.texture);
        value = {value.r * mean.r, value.g * mean.g, value.b * mean.b};
    }
    if (value != usual) json[key] = color_factor(value);
    if (!info.is_null()) json[texture_key] = std::move(info);
}

namespace {

bool is_metal(MaterialKind kind)
{
    return kind == MaterialKind::metal || kind == MaterialKind::fuzz_metal;
}

bool has_facets(MaterialKind kind)
{
    return is_metal(kind) || kind == MaterialKind::glass || kind == MaterialKind::plastic ||
           kind == MaterialKind::principled;
}

/// The color that glTF's base color must be: that of transmission in clear materials, else that of reflection.
ColorInput base_color(const Material& m)
{
    const bool is_clear = m.kind == MaterialKind::glass || (m.transmission.weight.value > 0 && m.metallic.value == 0);
    if (is_clear) return m.transmission.color;
    if (m.kind == MaterialKind::none) return {{0, 0, 0}, -1};
    return m.base_color;
}

}  // namespace

void GlbMaterials::put_base_color(const Material& m, Json& json)
{
    const ColorInput color = base_color(m);
    put_color(json, "baseColorFactor", color, {1, 1, 1}, "baseColorTexture");
    if (json.contains("baseColorFactor"))
        for (Json& channel : json["baseColorFactor"])
            if (channel.get<float>() > 1) channel = 1, report("a color brighter than white");
    if (m.opacity.mode != AlphaMode::opaque) {
        if (m.opacity.alpha.value != 1) {
            if (!json.contains("baseColorFactor")) json["baseColorFactor"] = color_factor({1, 1, 1});
            json["baseColorFactor"].push_back(number_json(m.opacity.alpha.value));
        }
        if (m.opacity.alpha.texture >= 0 &&
            (m.opacity.alpha.texture != color.texture || m.opacity.alpha.channel != alpha))
            report("an alpha other than the base color's");
    }
    if (json.contains("baseColorFactor") && json["baseColorFactor"].size() == 3) json["baseColorFactor"].push_back(1);
}

/// The GGX roughness that is closest to the material's roughness.
FloatInput GlbMaterials::ggx_roughness(const Material& m)
{
    FloatInput roughness = has_facets(m.kind) ? m.roughness : FloatInput{1, -1, green};
    if (m.kind == MaterialKind::fuzz_metal) {
        roughness = {std::sqrt(m.fuzz), -1, green};
        if (m.fuzz > 0) report("fuzz: roughness is used instead");
    }
    if (m.microfacets.beckmann && has_facets(m.kind)) {
        roughness.value *= 0.83666f;
        if (roughness.value > 0) report("the Beckmann distribution: it is approximated by GGX");
    }
    return roughness;
}

void GlbMaterials::put_metallic_roughness(const Material& m, Json& json)
{
    const FloatInput metallic =
        m.kind == MaterialKind::principled ? m.metallic : FloatInput{is_metal(m.kind) ? 1.f : 0.f, -1, blue};
    const FloatInput roughness = ggx_roughness(m);
    if (m.kind == MaterialKind::hair) report("hair scattering: it is approximated by a diffuse material");
    if (m.kind == MaterialKind::plastic) report("internal reflections below the boundary of plastic");
    put_factor(json, "metallicFactor", metallic, 1, "metallicRoughnessTexture", blue);
    put_factor(json, "roughnessFactor", roughness, 1, "metallicRoughnessTexture", green);
    const bool has_both = json.contains("metallicRoughnessTexture") && roughness.texture == metallic.texture;
    const bool other_is_zero = roughness.texture >= 0 ? metallic.value == 0 : roughness.value == 0;
    if (json.contains("metallicRoughnessTexture") && !has_both && !other_is_zero)
        report("metalness and roughness that are not in one image");
}

void GlbMaterials::add_transmission(const Material& m, Json& json)
{
    const bool is_glass = m.kind == MaterialKind::glass;
    const FloatInput transmission = is_glass ? FloatInput{1, -1, red} : m.transmission.weight;
    if (transmission.value > 0)
        put_factor(extension(json, "KHR_materials_transmission"), "transmissionFactor", transmission, 0,
                   "transmissionTexture", red);
    if (m.diffuse_transmission.weight.value > 0) {
        if (m.diffuse_transmission.added) report("diffuse transmission that is added to the reflection");
        Json& passing = extension(json, "KHR_materials_diffuse_transmission");
        put_factor(passing, "diffuseTransmissionFactor", m.diffuse_transmission.weight, 0, "diffuseTransmissionTexture",
                   alpha);
        put_color(passing, "diffuseTransmissionColorFactor", m.diffuse_transmission.color, {1, 1, 1},
                  "diffuseTransmissionColorTexture");
    }
    if (transmission.value <= 0 && m.diffuse_transmission.weight.value <= 0) return;
    if (m.transmission.dispersion > 0)
        extension(json, "KHR_materials_dispersion")["dispersion"] = number_json(m.transmission.dispersion);
    if (m.interior.thin) {
        if (is_glass && m.interior.attenuation_distance > 0) report("the absorption of a thin sheet of glass");
        return;
    }
    // Any thickness makes the material volumetric: ray tracers compute distances, and rasterizers approximate.
    Json& volume = extension(json, "KHR_materials_volume");
    volume["thicknessFactor"] = 1;
    if (m.interior.attenuation_distance > 0) {
        volume["attenuationDistance"] = number_json(m.interior.attenuation_distance);
        volume["attenuationColor"] = color_factor(m.interior.attenuation_color);
    }
}

/// Writes the thickness of the thin film. glTF's texture interpolates between two thicknesses, which the glTF reader
/// turns into a mix of two grays by an image; only such textures can be written.
Json GlbMaterials::thickness_info(const Material& m, Json& layer)
{
    const FloatInput& input = m.thin_film.thickness;
    const Texture* mix = input.texture >= 0 ? &scene_.textures[std::size_t(input.texture)] : nullptr;
    if (mix && mix->kind == TextureKind::mix && mix->color_a.texture < 0 && mix->color_b.texture < 0 &&
        mix->factor.texture >= 0 && mix->factor.value == 1 && mix->factor.channel == green) {
        layer["iridescenceThicknessMinimum"] = number_json(mix->color_a.value.g * input.value);
        layer["iridescenceThicknessMaximum"] = number_json(mix->color_b.value.g * input.value);
        return texture_info(mix->factor.texture, ColorSpace::linear);
    }
    float value = input.value;
    if (input.texture >= 0) {
        report("this texture of the thin film's thickness: its mean is used");
        value *= mean_of(input.texture).g;
    }
    layer["iridescenceThicknessMaximum"] = number_json(value);
    return {};
}

void GlbMaterials::add_layers(const Material& m, Json& json)
{
    if (m.specular.weight.value != 1 || m.specular.weight.texture >= 0 || !is_gray(m.specular.color.value, 1) ||
        m.specular.color.texture >= 0) {
        Json& specular = extension(json, "KHR_materials_specular");
        put_factor(specular, "specularFactor", m.specular.weight, 1, "specularTexture", alpha);
        put_color(specular, "specularColorFactor", m.specular.color, {1, 1, 1}, "specularColorTexture");
    }
    // A coat with index 1 doesn't reflect and only tints the layers below.
    if (m.coat.weight.value > 0 && m.coat.ior > 1) {
        Json& coat = extension(json, "KHR_materials_clearcoat");
        put_factor(coat, "clearcoatFactor", m.coat.weight, 0, "clearcoatTexture", red);
        put_factor(coat, "clearcoatRoughnessFactor", m.coat.roughness, 0, "clearcoatRoughnessTexture", green);
        put_normal(coat, "clearcoatNormalTexture", m.coat.normal_texture, m.coat.normal_scale);
    }
    if (m.thin_film.weight.value > 0) {
        Json& film = extension(json, "KHR_materials_iridescence");
        put_factor(film, "iridescenceFactor", m.thin_film.weight, 0, "iridescenceTexture", red);
        film["iridescenceIor"] = number_json(m.thin_film.ior);
        if (Json info = thickness_info(m, film); !info.is_null()) film["iridescenceThicknessTexture"] = std::move(info);
    }
    if (m.microfacets.anisotropy.value > 0) {
        Json& anisotropy = extension(json, "KHR_materials_anisotropy");
        put_factor(anisotropy, "anisotropyStrength", m.microfacets.anisotropy, 0, "anisotropyTexture", blue);
        if (m.microfacets.anisotropy_rotation != 0)
            anisotropy["anisotropyRotation"] = number_json(m.microfacets.anisotropy_rotation);
        if (m.microfacets.anisotropy_texture != m.microfacets.anisotropy.texture)
            report("the direction and strength of anisotropy from different images");
    }
    if (!is_gray(m.sheen.color.value, 0)) {
        Json& sheen = extension(json, "KHR_materials_sheen");
        put_color(sheen, "sheenColorFactor", m.sheen.color, {0, 0, 0}, "sheenColorTexture");
        put_factor(sheen, "sheenRoughnessFactor", m.sheen.roughness, 0, "sheenRoughnessTexture", alpha);
    }
}

void GlbMaterials::report_losses(const Material& m)
{
    if (m.visibility.black_back) report("a black back: it looks like the front");
    const auto lost = [&](bool has, const char* what) {
        if (has) report(what);
    };
    lost(m.displacement.height.value != 0, "displacement");
    lost(m.bump.texture >= 0 && m.bump.value != 0, "bumps");
    lost(m.microfacets.separable_masking && !m.microfacets.beckmann && m.roughness.value > 0,
         "separable masking-shadowing");
    lost(m.interior.priority != 0, "the priority of overlapping solids");
    if (m.kind == MaterialKind::diffuse) lost(m.roughness.value > 0, "a diffuse surface's roughness");
    if (m.kind != MaterialKind::principled) return;
    lost(m.subsurface.weight.value > 0, "subsurface scattering");
    lost(!is_gray(m.interior.scatter, 0), "scattering inside a solid");
    lost(m.diffuse_roughness.value > 0, "a diffuse surface's roughness");
    lost(m.metallic.value > 0 && (!is_gray(m.conductor.edge_color.value, 1) || m.conductor.edge_color.texture >= 0),
         "a metal's edge color");
    lost(m.coat.weight.value > 0 && (!is_gray(m.coat.color.value, 1) || m.coat.color.texture >= 0), "a coat's color");
    lost(m.coat.weight.value > 0 && m.coat.ior > 1 && m.coat.ior != 1.5f, "a coat's index of refraction");
    const bool is_partly_clear =
        m.transmission.weight.value > 0 && (m.metallic.value > 0 || m.transmission.weight.value < 1);
    lost(is_partly_clear &&
             (m.transmission.color.value != m.base_color.value || m.transmission.color.texture != m.base_color.texture),
         "different colors for reflection and transmission");
}

namespace {

/// Converts two roughnesses to glTF's roughness and anisotropy. False if textures prevent it: the roughness across the
/// tangent is kept then.
bool anisotropy_from_roughnesses(Material& m)
{
    const FloatInput along = m.microfacets.anisotropy;
    const bool is_plain = along.texture < 0 && m.roughness.texture < 0;
    m.microfacets.two_roughnesses = false;
    m.microfacets.anisotropy = {0, -1, 2};
    if (!is_plain) return false;
    const double u = double(along.value) * double(along.value),
                 v = double(m.roughness.value) * double(m.roughness.value);
    const double narrow = std::min(u, v), wide = std::max(u, v);
    m.roughness.value = float(std::sqrt(narrow));
    if (wide > narrow) m.microfacets.anisotropy.value = float(std::sqrt((wide - narrow) / (1 - narrow)));
    if (v > u) m.microfacets.anisotropy_rotation += std::numbers::pi / 2;
    return true;
}

/// The principled layers that come closest to a Disney material.
Material principled_from_disney(Material m)
{
    m.kind = MaterialKind::principled;
    m.transmission.color = m.base_color;
    m.diffuse_transmission.color = m.base_color;
    if (m.microfacets.anisotropy.value > 0) {
        // Disney's aspect: alpha is roughness^2 divided and multiplied by sqrt(1 - 0.9 anisotropy).
        const double aspect = std::sqrt(1 - 0.9 * double(m.microfacets.anisotropy.value));
        const double square = double(m.roughness.value) * double(m.roughness.value);
        m.microfacets.anisotropy.value = float(std::sqrt(std::min(1.0, square / aspect)));
        m.roughness.value = float(std::sqrt(square * aspect));
        m.microfacets.two_roughnesses = true;
    }
    // Disney's clearcoat is a quarter of a boundary of index 1.5, with alpha from 0.1 to 0.001.
    m.coat.weight.value *= 0.25f;
    m.coat.roughness = {std::sqrt(0.1f + m.disney.coat_gloss.value * (0.001f - 0.1f)), -1, green};
    const float sheen = m.disney.sheen.value;
    m.sheen.color = {{sheen, sheen, sheen}, m.disney.sheen.texture};
    return m;
}

}  // namespace

/// Replaces the material by one that glTF has the terms for, and reports what is lost.
Material GlbMaterials::approximated(Material m)
{
    if (m.kind == MaterialKind::measured) {
        report("a measured BRDF: it is approximated by a diffuse material");
        m.base_color = {reflectance_of(scene_.measured[std::size_t(m.measured)]), -1};
        m.kind = MaterialKind::diffuse;
    }
    if (m.kind == MaterialKind::disney) {
        report("the sum of the Disney material's lobes: they are written as layers");
        m = principled_from_disney(m);
    }
    if (m.microfacets.two_roughnesses && !anisotropy_from_roughnesses(m))
        report("textures of two roughnesses: the one along the tangent is ignored");
    return m;
}

void GlbMaterials::put_normal(Json& json, const char* key, int texture, float scale)
{
    Json info = texture_info(texture, ColorSpace::linear);
    if (info.is_null()) return;
    if (scale != 1) info["scale"] = number_json(scale);
    json[key] = std::move(info);
}

void GlbMaterials::put_emission(const Material& m, Json& json)
{
    const Color e = m.emission.radiance.value;
    const float strength = std::max({e.r, e.g, e.b, 1.f});
    put_color(json, "emissiveFactor", {{e.r / strength, e.g / strength, e.b / strength}, m.emission.radiance.texture},
              {0, 0, 0}, "emissiveTexture");
    if (strength > 1) extension(json, "KHR_materials_emissive_strength")["emissiveStrength"] = number_json(strength);
    // glTF has one flag for both; emission takes precedence over the visibility of the back.
    if (m.emission.two_sided == m.visibility.camera_backface_culling)
        report(m.visibility.camera_backface_culling
                   ? "two-sided emission of a single-sided surface: the surface becomes double-sided"
                   : "one-sided emission of a double-sided surface: the surface becomes single-sided");
}

void GlbMaterials::put_alpha_mode(const Material& m, Json& json)
{
    if (m.opacity.mode != AlphaMode::opaque) json["alphaMode"] = m.opacity.mode == AlphaMode::mask ? "MASK" : "BLEND";
    if (m.opacity.mode == AlphaMode::mask && m.opacity.cutoff != 0.5f)
        json["alphaCutoff"] = number_json(m.opacity.cutoff);
}

Json GlbMaterials::material_json(const Material& given)
{
    current_ = &given;
    const Material m = approximated(given);
    Json json = Json::object(), base = Json::object();
    if (!m.name.empty()) json["name"] = m.name;
    put_base_color(m, base);
    put_metallic_roughness(m, base);
    if (!base.empty()) json["pbrMetallicRoughness"] = std::move(base);
    put_normal(json, "normalTexture", m.normal_map.texture, m.normal_map.scale);
    const bool emits =
        std::max({m.emission.radiance.value.r, m.emission.radiance.value.g, m.emission.radiance.value.b}) > 0;
    if (emits) put_emission(m, json);
    put_alpha_mode(m, json);
    if (emits ? m.emission.two_sided : !m.visibility.camera_backface_culling) json["doubleSided"] = true;

    if (m.kind == MaterialKind::unlit) extension(json, "KHR_materials_unlit");
    // These kinds have no specular boundary.
    if (m.kind == MaterialKind::diffuse || m.kind == MaterialKind::none)
        extension(json, "KHR_materials_specular")["specularFactor"] = 0;
    if (m.kind == MaterialKind::glass || m.kind == MaterialKind::principled) {
        if (m.ior != 1.5f) extension(json, "KHR_materials_ior")["ior"] = number_json(m.ior < 10000 ? m.ior : 0);
        add_transmission(m, json);
    }
    if (m.kind == MaterialKind::principled) add_layers(m, json);
    report_losses(m);
    return json;
}

}  // namespace fathom
