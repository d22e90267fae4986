// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/values.h"
#include "formats/io/read_file.h"

namespace fathom {

void GltfReader::read_metallic_roughness(const JsonValue& v, Material& m)
{
    if (const auto factor = v.get("baseColorFactor")) {
        factor->array_of(4);
        m.base_color.value = clamped(*factor);
        m.opacity.alpha.value = std::clamp((*factor)[3].single(), 0.0f, 1.0f);
    }
    if (const auto info = v.get("baseColorTexture")) {
        m.base_color.texture = texture(*info, ColorSpace::srgb);
        m.opacity.alpha.texture = m.base_color.texture;
    }
    m.metallic.value = factor_or(v, "metallicFactor", 1);
    m.roughness.value = factor_or(v, "roughnessFactor", 1);
    if (const auto info = v.get("metallicRoughnessTexture"))
        m.metallic.texture = m.roughness.texture = texture(*info, ColorSpace::linear);
}

Material GltfReader::read_material(const JsonValue& v)
{
    Material m;
    m.kind = MaterialKind::principled;
    m.sheen.reciprocal = true;
    if (const auto name = v.get("name")) m.name = printable(name->string());
    m.base_color = {{1, 1, 1}, -1};
    m.metallic = {1, -1, 2};
    m.roughness = {1, -1, 1};
    if (const auto pbr = v.get("pbrMetallicRoughness")) read_metallic_roughness(*pbr, m);

    if (const auto info = v.get("normalTexture")) {
        m.normal_map.texture = texture(*info, ColorSpace::linear);
        m.normal_map.scale = float_or(*info, "scale", 1);
    }
    if (const auto factor = v.get("emissiveFactor")) {
        factor->array_of(3);
        m.emission.radiance.value = clamped(*factor);
    }
    if (const auto info = v.get("emissiveTexture")) m.emission.radiance.texture = texture(*info, ColorSpace::srgb);
    // A single-sided surface is invisible from behind and emits only to the front.
    if (const auto two_sided = v.get("doubleSided")) m.emission.two_sided = two_sided->boolean();
    m.visibility.camera_backface_culling = !m.emission.two_sided;

    if (const auto mode = v.get("alphaMode")) {
        const std::string& word = mode->string();
        if (word == "MASK")
            m.opacity.mode = AlphaMode::mask;
        else if (word == "BLEND")
            m.opacity.mode = AlphaMode::blend;
        else if (word != "OPAQUE")
            mode->fail(fmt::format("'{}' is not one of OPAQUE, MASK, BLEND", printable(word)));
    }
    m.opacity.cutoff = float_or(v, "alphaCutoff", 0.5f);

    if (const auto extensions = v.get("extensions")) {
        if (const auto gloss = extensions->get("KHR_materials_pbrSpecularGlossiness");
            gloss && !v.has("pbrMetallicRoughness"))
            read_specular_glossiness(*gloss, m);
        if (const auto strength = extensions->get("KHR_materials_emissive_strength")) {
            const float s = std::max(0.0f, float_or(*strength, "emissiveStrength", 1));
            m.emission.radiance.value = {m.emission.radiance.value.r * s, m.emission.radiance.value.g * s,
                                         m.emission.radiance.value.b * s};
        }
        if (extensions->has("KHR_materials_unlit"))
            m.kind = MaterialKind::unlit;
        else
            read_layers(*extensions, m);
    }
    if (m.opacity.mode == AlphaMode::opaque) m.opacity.alpha = {1, -1, 3};
    return m;
}

/// Index of the primitive's material, or that of the selected variant if it has one.
std::optional<std::size_t> GltfReader::material_index(const JsonValue& primitive)
{
    const auto checked = [&](const JsonValue& index) {
        file_.follow("materials", index);
        return index.count();
    };
    const auto extensions = primitive.get("extensions");
    const auto extension = extensions ? extensions->get("KHR_materials_variants") : std::nullopt;
    if (variant_ && extension && extension->has("mappings")) {
        const JsonValue mappings = (*extension)["mappings"];
        mappings.array();
        for (std::size_t i = 0; i < mappings.size(); ++i) {
            const JsonValue mapping = mappings[i];
            for (const char* key : {"material", "variants"})
                if (!mapping.has(key)) mapping.fail(fmt::format("key '{}' is missing", key));
            const JsonValue variants = mapping["variants"];
            variants.array();
            for (std::size_t k = 0; k < variants.size(); ++k)
                if (variants[k].count() == *variant_) return checked(mapping["material"]);
        }
    }
    const auto index = primitive.get("material");
    return index ? std::optional(checked(*index)) : std::nullopt;
}

int GltfReader::material(const JsonValue& primitive, bool has_colors)
{
    const std::optional<std::size_t> index = material_index(primitive);
    const std::pair<int, bool> key = {index ? int(*index) : -1, has_colors};
    if (const auto found = materials_.find(key); found != materials_.end()) return found->second;
    static const Json no_material = Json::object();
    Material m = index ? read_material(file_.list("materials")[*index])
                       : read_material(JsonValue(file_.name(), no_material, PlaceStyle::path));
    m.use_vertex_color = has_colors;
    const int result = int(scene_.materials.size());
    scene_.materials.push_back(std::move(m));
    materials_.emplace(key, result);
    return result;
}

}  // namespace fathom
