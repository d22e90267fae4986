#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "import/common/read_file.h"
#include "import/gltf/data_uri.h"
#include "import/gltf/gltf_reader.h"

namespace fathom {

namespace {

float float_or(const JsonValue& v, const char* key, float otherwise)
{
    return v.has(key) ? v[key].single() : otherwise;
}

/// A factor that the format bounds by 0 and 1.
float factor_or(const JsonValue& v, const char* key, float otherwise)
{
    return std::clamp(float_or(v, key, otherwise), 0.0f, 1.0f);
}

Color clamped(const JsonValue& v, std::size_t i0 = 0)
{
    const auto channel = [&](std::size_t i) { return std::clamp(v[i].single(), 0.0f, 1.0f); };
    return {channel(i0), channel(i0 + 1), channel(i0 + 2)};
}

Wrap wrap(const JsonValue& sampler, const char* key)
{
    const int mode = sampler.has(key) ? sampler[key].integer() : 10497;
    switch (mode) {
        case 10497:
            return Wrap::repeat;
        case 33071:
            return Wrap::clamp;
        case 33648:
            return Wrap::mirror;
        default:
            sampler[key].fail(fmt::format("{} is no wrap mode", mode));
    }
}

/// A member of "extensions", if the object has it.
std::optional<JsonValue> extension(const std::optional<JsonValue>& extensions, const char* name)
{
    return extensions ? extensions->get(name) : std::nullopt;
}

}  // namespace

int GltfReader::image(const JsonValue& index)
{
    const auto [found, is_new] = images_.try_emplace(index.count(), -1);
    if (!is_new) return found->second;
    const JsonValue v = file_.follow("images", index);
    ImageFile image;
    if (const auto name = v.get("name")) image.name = printable(name->string());
    if (const auto uri = v.get("uri")) {
        const std::string& text = uri->string();
        if (is_data_uri(text)) {
            const std::optional<std::string> bytes = decode_data_uri(text);
            if (!bytes) uri->fail("the data URI is damaged");
            image.bytes.resize(bytes->size());
            std::memcpy(image.bytes.data(), bytes->data(), bytes->size());
        } else {
            image.path = file_.path().parent_path() / decode_percent(text);
        }
        if (image.name.empty()) image.name = is_data_uri(text) ? v.place() : printable(text);
    } else if (const auto view = v.get("bufferView")) {
        const GltfFile::View bytes = file_.buffer_view(*view);
        image.bytes.resize(bytes.bytes.size());
        std::memcpy(image.bytes.data(), bytes.bytes.data(), bytes.bytes.size());
        if (image.name.empty()) image.name = v.place();
    } else {
        v.fail("there is neither 'uri' nor 'bufferView'");
    }
    found->second = int(scene_.images.size());
    scene_.images.push_back(std::move(image));
    return found->second;
}

std::optional<int> GltfReader::texture_image(const JsonValue& texture)
{
    const auto extensions = texture.get("extensions");
    if (const auto webp = extension(extensions, "EXT_texture_webp"))
        if (const auto source = webp->get("source")) return image(*source);
    if (const auto source = texture.get("source")) return image(*source);
    file_.warn(extension(extensions, "KHR_texture_basisu")
                   ? "KHR_texture_basisu: textures in KTX2 are not supported and left out"
                   : "textures without an image are left out");
    return std::nullopt;
}

int GltfReader::texture(const JsonValue& info, ColorSpace color_space)
{
    info.object();
    if (!info.has("index")) info.fail("key 'index' is missing");
    const JsonValue index = info["index"];
    const JsonValue v = file_.follow("textures", index);

    Texture texture;
    texture.color_space = color_space;
    if (const auto name = v.get("name")) texture.name = printable(name->string());
    const std::optional<int> source = texture_image(v);
    if (!source) return -1;
    texture.image = *source;
    if (const auto sampler_index = v.get("sampler")) {
        const JsonValue sampler = file_.follow("samplers", *sampler_index);
        texture.wrap_u = wrap(sampler, "wrapS");
        texture.wrap_v = wrap(sampler, "wrapT");
        if (const auto filter = sampler.get("magFilter")) texture.nearest = filter->integer() == 9728;
    }

    if (const auto set = info.get("texCoord")) texture.uv_set = set->integer();
    if (const auto extensions = info.get("extensions")) {
        if (const auto transform = extensions->get("KHR_texture_transform")) {
            if (const auto offset = transform->get("offset")) texture.uv_offset = offset->vec2f();
            if (const auto scale = transform->get("scale")) texture.uv_scale = scale->vec2f();
            texture.uv_rotation = float_or(*transform, "rotation", 0);
            if (const auto set = transform->get("texCoord")) texture.uv_set = set->integer();
        }
    }
    if (texture.uv_set != 0 && texture.uv_set != 1) {
        file_.warn("texture coordinates beyond the second set are not supported; the first is used");
        texture.uv_set = 0;
    }
    const std::string key =
        fmt::format("{} {} {} {} {} {} {} {}", index.count(), int(color_space), texture.uv_set, texture.uv_offset.x,
                    texture.uv_offset.y, texture.uv_scale.x, texture.uv_scale.y, texture.uv_rotation);
    const auto [found, is_new] = textures_.try_emplace(key, int(scene_.textures.size()));
    if (is_new) scene_.textures.push_back(std::move(texture));
    return found->second;
}

void GltfReader::read_metallic_roughness(const JsonValue& v, Material& m)
{
    if (const auto factor = v.get("baseColorFactor")) {
        factor->array_of(4);
        m.base_color.value = clamped(*factor);
        m.alpha.value = std::clamp((*factor)[3].single(), 0.0f, 1.0f);
    }
    if (const auto info = v.get("baseColorTexture")) {
        m.base_color.texture = texture(*info, ColorSpace::srgb);
        m.alpha.texture = m.base_color.texture;
    }
    m.metallic.value = factor_or(v, "metallicFactor", 1);
    m.roughness.value = factor_or(v, "roughnessFactor", 1);
    if (const auto info = v.get("metallicRoughnessTexture"))
        m.metallic.texture = m.roughness.texture = texture(*info, ColorSpace::linear);
}

void GltfReader::read_specular_glossiness(const JsonValue& v, Material& m)
{
    file_.warn("KHR_materials_pbrSpecularGlossiness is shown as a dielectric of the same colour and gloss");
    m.metallic = {0, -1, 2};
    m.roughness = {1 - factor_or(v, "glossinessFactor", 1), -1, 1};
    m.base_color = {{1, 1, 1}, -1};
    if (const auto factor = v.get("diffuseFactor")) {
        factor->array_of(4);
        m.base_color.value = clamped(*factor);
        m.alpha.value = std::clamp((*factor)[3].single(), 0.0f, 1.0f);
    }
    if (const auto info = v.get("diffuseTexture"))
        m.base_color.texture = m.alpha.texture = texture(*info, ColorSpace::srgb);
}

void GltfReader::read_transmission(const JsonValue& extensions, Material& m)
{
    const auto transmission = extensions.get("KHR_materials_transmission");
    if (!transmission) return;
    const float factor = factor_or(*transmission, "transmissionFactor", 0);
    if (factor == 0) return;
    if (factor < 0.5f || transmission->has("transmissionTexture"))
        file_.warn("KHR_materials_transmission is shown as none or all: partial transmission is not supported");
    if (factor < 0.5f) return;
    m.kind = MaterialKind::glass;
    // What is reflected keeps its colour; base colour is for what passes.
    m.transmission_color = m.base_color;
    const auto volume = extensions.get("KHR_materials_volume");
    if (!volume || float_or(*volume, "thicknessFactor", 0) <= 0) {
        m.thin = true;
        return;
    }
    if (const auto color = volume->get("attenuationColor")) {
        color->array_of(3);
        m.attenuation_color = clamped(*color);
    }
    if (const auto distance = volume->get("attenuationDistance"))
        m.attenuation_distance = std::max(0.0, distance->number());
}

Material GltfReader::read_material(const JsonValue& v)
{
    Material m;
    m.kind = MaterialKind::principled;
    if (const auto name = v.get("name")) m.name = printable(name->string());
    m.base_color = {{1, 1, 1}, -1};
    m.metallic = {1, -1, 2};
    m.roughness = {1, -1, 1};
    if (const auto pbr = v.get("pbrMetallicRoughness")) read_metallic_roughness(*pbr, m);

    if (const auto info = v.get("normalTexture")) {
        m.normal_texture = texture(*info, ColorSpace::linear);
        m.normal_scale = float_or(*info, "scale", 1);
    }
    if (const auto factor = v.get("emissiveFactor")) {
        factor->array_of(3);
        m.emission.value = clamped(*factor);
    }
    if (const auto info = v.get("emissiveTexture")) m.emission.texture = texture(*info, ColorSpace::srgb);
    // A single-sided surface is invisible from behind, and so is its light.
    if (const auto two_sided = v.get("doubleSided")) m.emission_two_sided = two_sided->boolean();

    if (const auto mode = v.get("alphaMode")) {
        const std::string& word = mode->string();
        if (word == "MASK")
            m.alpha_mode = AlphaMode::mask;
        else if (word == "BLEND")
            m.alpha_mode = AlphaMode::blend;
        else if (word != "OPAQUE")
            mode->fail(fmt::format("'{}' is none of OPAQUE, MASK, BLEND", printable(word)));
    }
    m.alpha_cutoff = float_or(v, "alphaCutoff", 0.5f);

    if (const auto extensions = v.get("extensions")) {
        if (const auto gloss = extensions->get("KHR_materials_pbrSpecularGlossiness");
            gloss && !v.has("pbrMetallicRoughness"))
            read_specular_glossiness(*gloss, m);
        if (const auto strength = extensions->get("KHR_materials_emissive_strength")) {
            const float s = std::max(0.0f, float_or(*strength, "emissiveStrength", 1));
            m.emission.value = {m.emission.value.r * s, m.emission.value.g * s, m.emission.value.b * s};
        }
        if (const auto ior = extensions->get("KHR_materials_ior")) {
            const float index = float_or(*ior, "ior", 1.5f);
            // 0 stands for an index so high that everything is reflected.
            m.ior = index == 0 ? 100.0f : std::clamp(index, 1.0f, 100.0f);
        }
        if (extensions->has("KHR_materials_unlit"))
            m.kind = MaterialKind::unlit;
        else
            read_transmission(*extensions, m);
    }
    if (m.alpha_mode == AlphaMode::opaque) m.alpha = {1, -1, 3};
    return m;
}

/// That of the variant, if it has one for this primitive.
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
