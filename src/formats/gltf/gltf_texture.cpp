// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstring>

#include "formats/gltf/data_uri.h"
#include "formats/gltf/gltf_reader.h"
#include "formats/gltf/values.h"
#include "formats/io/read_file.h"

namespace fathom {

namespace {

#ifdef FATHOM_HAS_BASIS
constexpr bool reads_basis = true;
#else
constexpr bool reads_basis = false;
#endif

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
            sampler[key].fail(fmt::format("{} is not a wrap mode", mode));
    }
}

/// A member of "extensions", if it exists.
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

/// The image in the first encoding that this build supports.
std::optional<int> GltfReader::texture_image(const JsonValue& texture)
{
    const auto extensions = texture.get("extensions");
    const auto basis = extension(extensions, "KHR_texture_basisu");
    if (reads_basis && basis)
        if (const auto source = basis->get("source")) return image(*source);
    for (const char* const format : {"EXT_texture_avif", "EXT_texture_webp"})
        if (const auto named = extension(extensions, format))
            if (const auto source = named->get("source")) return image(*source);
    if (const auto source = texture.get("source")) return image(*source);
    file_.warn(basis ? "KHR_texture_basisu: this build does not support KTX2; such textures are ignored"
                     : "textures without an image are ignored");
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

}  // namespace fathom
