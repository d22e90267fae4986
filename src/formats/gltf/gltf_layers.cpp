// SPDX-License-Identifier: Apache-2.0
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/texture_channel.h"
#include "formats/gltf/values.h"
#include "scene/scattering.h"

/// Extensions that add layers to a material. Each factor is multiplied with the texture channel that the extension's
/// specification names.
namespace fathom {

namespace {

using namespace texture_channel;

/// KHR_materials_volume_scatter: the scattered fraction of the volume's extinction.
void read_scatter(const JsonValue& v, Material& m)
{
    m.transmission_scatter_anisotropy = std::clamp(float_or(v, "scatterAnisotropy", 0), -0.99f, 0.99f);
    const auto color = v.get("multiscatterColor");
    if (!color) return;
    color->array_of(3);
    const auto scattered = [](float shown, float left) {
        return float(single_scattering_albedo(double(shown), 0) * -std::log(std::max(double(left), 1e-6)));
    };
    const Color shown = clamped(*color), left = m.attenuation_color;
    m.transmission_scatter = {scattered(shown.r, left.r), scattered(shown.g, left.g), scattered(shown.b, left.b)};
}

}  // namespace

FloatInput GltfReader::factor(const JsonValue& v, const char* factor, float otherwise, const char* texture_key,
                              int channel)
{
    FloatInput input{factor_or(v, factor, otherwise), -1, channel};
    if (const auto info = v.get(texture_key)) input.texture = texture(*info, ColorSpace::linear);
    return input;
}

ColorInput GltfReader::color(const JsonValue& v, const char* factor, Color otherwise, const char* texture_key)
{
    ColorInput input{otherwise, -1};
    if (const auto value = v.get(factor)) {
        value->array_of(3);
        input.value = clamped(*value);
    }
    if (const auto info = v.get(texture_key)) input.texture = texture(*info, ColorSpace::srgb);
    return input;
}

int GltfReader::add_mix(Color a, Color b, FloatInput by)
{
    Texture t;
    t.kind = TextureKind::mix;
    t.color_a.value = a, t.color_b.value = b;
    t.factor = by;
    scene_.textures.push_back(t);
    return int(scene_.textures.size()) - 1;
}

/// KHR_materials_pbrSpecularGlossiness: a specular boundary with the given color over a diffuse base, as the
/// extension's specification converts it.
void GltfReader::read_specular_glossiness(const JsonValue& v, Material& m)
{
    m.metallic = {0, -1, blue};
    m.ior = mirror_ior;
    m.base_color = {{1, 1, 1}, -1};
    if (const auto diffuse = v.get("diffuseFactor")) {
        diffuse->array_of(4);
        m.base_color.value = clamped(*diffuse);
        m.alpha.value = std::clamp((*diffuse)[3].single(), 0.0f, 1.0f);
    }
    if (const auto info = v.get("diffuseTexture"))
        m.base_color.texture = m.alpha.texture = texture(*info, ColorSpace::srgb);
    m.specular_color = color(v, "specularFactor", {1, 1, 1}, "specularGlossinessTexture");
    const float glossiness = factor_or(v, "glossinessFactor", 1);
    m.roughness = {1 - glossiness, -1, green};
    if (m.specular_color.texture < 0) return;
    // Roughness is 1 - factor * texture.
    const auto rough = [](float r) { return Color{r, r, r}; };
    m.roughness = {1, add_mix(rough(1), rough(1 - glossiness), {1, m.specular_color.texture, alpha}), green};
}

void GltfReader::read_transmission(const JsonValue& extensions, Material& m)
{
    const auto volume = extensions.get("KHR_materials_volume");
    m.thin = !volume || float_or(*volume, "thicknessFactor", 0) <= 0;
    if (const auto v = extensions.get("KHR_materials_transmission")) {
        m.transmission = factor(*v, "transmissionFactor", 0, "transmissionTexture", red);
        // Reflection is untinted; the base color tints transmission.
        m.transmission_color = m.base_color;
    }
    if (const auto v = extensions.get("KHR_materials_dispersion"))
        m.dispersion = std::clamp(float_or(*v, "dispersion", 0), 0.0f, 40.0f);
    if (const auto v = extensions.get("KHR_materials_diffuse_transmission")) {
        m.diffuse_transmission = factor(*v, "diffuseTransmissionFactor", 0, "diffuseTransmissionTexture", alpha);
        m.diffuse_transmission_color =
            color(*v, "diffuseTransmissionColorFactor", {1, 1, 1}, "diffuseTransmissionColorTexture");
    }
    if (m.thin) return;
    if (const auto color = volume->get("attenuationColor")) {
        color->array_of(3);
        m.attenuation_color = clamped(*color);
    }
    if (const auto distance = volume->get("attenuationDistance"))
        m.attenuation_distance = std::max(0.0, distance->number());
    if (const auto v = extensions.get("KHR_materials_volume_scatter")) read_scatter(*v, m);
}

void GltfReader::read_specular(const JsonValue& v, Material& m)
{
    m.specular = factor(v, "specularFactor", 1, "specularTexture", alpha);
    m.specular_color = color(v, "specularColorFactor", {1, 1, 1}, "specularColorTexture");
    // Only this factor may exceed 1.
    if (const auto tint = v.get("specularColorFactor")) {
        const auto channel = [&](std::size_t i) { return std::max((*tint)[i].single(), 0.0f); };
        m.specular_color.value = {channel(0), channel(1), channel(2)};
    }
}

void GltfReader::read_coat(const JsonValue& v, Material& m)
{
    m.coat = factor(v, "clearcoatFactor", 0, "clearcoatTexture", red);
    m.coat_roughness = factor(v, "clearcoatRoughnessFactor", 0, "clearcoatRoughnessTexture", green);
    m.coat_darkening = 0;  // KHR_materials_clearcoat doesn't darken the base
    if (const auto info = v.get("clearcoatNormalTexture")) {
        m.coat_normal_texture = texture(*info, ColorSpace::linear);
        m.coat_normal_scale = float_or(*info, "scale", 1);
    }
}

void GltfReader::read_iridescence(const JsonValue& v, Material& m)
{
    m.thin_film = factor(v, "iridescenceFactor", 0, "iridescenceTexture", red);
    m.thin_film_ior = std::clamp(float_or(v, "iridescenceIor", 1.3f), 1.0f, 3.0f);
    const auto nanometres = [&](const char* key, float otherwise) {
        return std::clamp(float_or(v, key, otherwise), 0.0f, 1e5f);
    };
    const float least = nanometres("iridescenceThicknessMinimum", 100),
                most = nanometres("iridescenceThicknessMaximum", 400);
    m.thin_film_thickness = {most, -1, green};
    const auto info = v.get("iridescenceThicknessTexture");
    if (!info) return;
    const int thickness = texture(*info, ColorSpace::linear);
    if (thickness < 0) return;
    const auto gray = [](float nm) { return Color{nm, nm, nm}; };
    m.thin_film_thickness = {1, add_mix(gray(least), gray(most), {1, thickness, green}), green};
}

void GltfReader::read_anisotropy(const JsonValue& v, Material& m)
{
    m.anisotropy = factor(v, "anisotropyStrength", 0, "anisotropyTexture", blue);
    m.anisotropy_rotation = float_or(v, "anisotropyRotation", 0);
    m.anisotropy_texture = m.anisotropy.texture;
}

void GltfReader::read_layers(const JsonValue& extensions, Material& m)
{
    if (const auto v = extensions.get("KHR_materials_ior")) {
        const float index = float_or(*v, "ior", 1.5f);
        // In KHR_materials_ior, 0 stands for an infinite index: Fresnel reflectance is 1 at all angles.
        m.ior = index == 0 ? mirror_ior : std::clamp(index, 1.0f, mirror_ior);
    }
    read_transmission(extensions, m);
    if (const auto v = extensions.get("KHR_materials_specular")) read_specular(*v, m);
    if (const auto v = extensions.get("KHR_materials_clearcoat")) read_coat(*v, m);
    if (const auto v = extensions.get("KHR_materials_iridescence")) read_iridescence(*v, m);
    if (const auto v = extensions.get("KHR_materials_anisotropy")) read_anisotropy(*v, m);
    if (const auto v = extensions.get("KHR_materials_sheen")) {
        m.sheen_color = color(*v, "sheenColorFactor", {0, 0, 0}, "sheenColorTexture");
        m.sheen_roughness = factor(*v, "sheenRoughnessFactor", 0, "sheenRoughnessTexture", alpha);
    }
}

}  // namespace fathom
