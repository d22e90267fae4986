// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "formats/gltf/glb_materials.h"
#include "formats/io/read_file.h"
#include "scene/texture_table.h"

namespace fathom {

namespace {

/// MIME type from the file's signature; nullptr for formats that glTF doesn't support.
const char* mime_type(std::string_view bytes)
{
    using namespace std::string_view_literals;
    if (bytes.starts_with("\x89PNG"sv)) return "image/png";
    if (bytes.starts_with("\xff\xd8"sv)) return "image/jpeg";
    if (bytes.starts_with("RIFF"sv)) return "image/webp";
    if (bytes.starts_with("\xabKTX 20\xbb"sv)) return "image/ktx2";
    if (bytes.size() > 12 && bytes.substr(4).starts_with("ftypavi"sv)) return "image/avif";
    return nullptr;
}

int wrap_mode(Wrap wrap)
{
    constexpr int repeat = 10497, clamp = 33071, mirror = 33648;
    constexpr int modes[] = {repeat, clamp, mirror, clamp, clamp};
    return modes[int(wrap)];
}

Color mixed(Color a, Color b, float t)
{
    return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}

bool is_identity(const Texture& t)
{
    return t.uv_offset.x == 0 && t.uv_offset.y == 0 && t.uv_scale.x == 1 && t.uv_scale.y == 1 && t.uv_rotation == 0;
}

}  // namespace

bool GlbMaterials::is_picture(int texture) const
{
    const Texture& t = scene_.textures[std::size_t(texture)];
    if (reads_position(t)) return false;
    if (t.kind == TextureKind::uv_transform && t.color_a.texture >= 0) return is_picture(t.color_a.texture);
    return t.kind == TextureKind::image;
}

Color GlbMaterials::mean_of(int texture) const
{
    if (texture < 0) return {1, 1, 1};
    const Texture& t = scene_.textures[std::size_t(texture)];
    const auto color = [&](const ColorInput& input) {
        const Color m = mean_of(input.texture);
        return Color{input.value.r * m.r, input.value.g * m.g, input.value.b * m.b};
    };
    switch (t.kind) {
        case TextureKind::image:
        case TextureKind::vertex_color:
            return {1, 1, 1};
        case TextureKind::uv_transform:
        case TextureKind::clamp:
            return color(t.color_a);
        case TextureKind::invert: {
            const Color c = color(t.color_a);
            return {std::max(1 - c.r, 0.f), std::max(1 - c.g, 0.f), std::max(1 - c.b, 0.f)};
        }
        case TextureKind::coordinates:
            return {0.5f, 0.5f, 0};
        case TextureKind::fbm:
        case TextureKind::windy:
            return color(t.color_a);
        case TextureKind::dots:
            return mixed(color(t.color_a), color(t.color_b), 0.19f);
        case TextureKind::veined_marble:
            return {0.78f, 0.78f, 0.8f};
        case TextureKind::scale: {
            const Color a = color(t.color_a), b = color(t.color_b);
            return {a.r * b.r, a.g * b.g, a.b * b.b};
        }
        case TextureKind::ramp: {
            Color sum;
            for (const RampStop& stop : t.stops)
                sum = {sum.r + stop.color.r, sum.g + stop.color.g, sum.b + stop.color.b};
            const float share = t.stops.empty() ? 0 : 1 / float(t.stops.size());
            return {sum.r * share, sum.g * share, sum.b * share};
        }
        case TextureKind::mix:
            return mixed(color(t.color_a), color(t.color_b), t.factor.texture < 0 ? t.factor.value : 0.5f);
        default:
            return mixed(color(t.color_a), color(t.color_b), 0.5f);
    }
}

const Texture* GlbMaterials::picture_of(int texture)
{
    const Texture& t = scene_.textures[std::size_t(texture)];
    if (reads_position(t)) return nullptr;
    if (t.kind == TextureKind::image) return &t;
    if (t.kind != TextureKind::uv_transform || t.color_a.texture < 0) return nullptr;
    return picture_of(t.color_a.texture);
}

Json GlbMaterials::texture_info(int texture, ColorSpace color_space)
{
    if (texture < 0) return {};
    const Texture& t = scene_.textures[std::size_t(texture)];
    const Texture* const picture = picture_of(texture);
    if (!picture || picture->image < 0) {
        if (t.kind != TextureKind::vertex_color) report("a procedural texture: its mean is used");
        return {};
    }
    if (picture != &t && !is_identity(*picture)) report("two nested transforms of texture coordinates");
    if (std::max(picture->wrap_u, picture->wrap_v) >= Wrap::black) report("this wrap mode: the texture is clamped");
    if (picture->height_scale != 0) {
        report("a height map");
        return {};
    }
    if (picture->color_space != color_space)
        report(color_space == ColorSpace::srgb ? "that an image's values are linear"
                                               : "that an image's values are sRGB");
    const int index = texture_json(*picture);
    if (index < 0) return {};
    Json info = {{"index", index}};
    if (t.uv_set != 0) info["texCoord"] = t.uv_set;
    if (is_identity(t)) return info;
    Json& transform = extension(info, "KHR_texture_transform");
    transform["offset"] = {number_json(t.uv_offset.x), number_json(t.uv_offset.y)};
    transform["scale"] = {number_json(t.uv_scale.x), number_json(t.uv_scale.y)};
    transform["rotation"] = number_json(t.uv_rotation);
    return info;
}

int GlbMaterials::texture_json(const Texture& t)
{
    const int picture = image(t.image);
    if (picture < 0) return -1;
    const int how = sampler(t);
    const auto [found, is_new] = textures_.try_emplace({picture, how}, int(texture_list_.size()));
    if (!is_new) return found->second;
    Json json = {{"sampler", how}};
    if (!t.name.empty()) json["name"] = t.name;
    const Json& listed = image_list_[std::size_t(picture)];
    const std::string mime = listed["mimeType"].get<std::string>();
    json["source"] = picture;
    for (const auto& [type, name] : {std::pair{"image/webp", "EXT_texture_webp"},
                                     {"image/avif", "EXT_texture_avif"},
                                     {"image/ktx2", "KHR_texture_basisu"}})
        if (mime == type) {
            json.erase("source");
            extension(json, name)["source"] = picture;
        }
    texture_list_.push_back(std::move(json));
    return found->second;
}

/// glTF index of an image; -1 if glTF doesn't support its format.
int GlbMaterials::image(int index)
{
    const auto [found, is_new] = images_.try_emplace(index, -1);
    if (!is_new) return found->second;
    const ImageFile& file = scene_.images[std::size_t(index)];
    const std::string read = file.bytes.empty() ? read_file(file.path) : std::string();
    const std::string_view bytes =
        file.bytes.empty() ? read
                           : std::string_view(reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size());
    const char* const mime = mime_type(bytes);
    if (!mime) {
        warnings_.add(fmt::format("{}: image '{}' is not written: glTF supports PNG, JPEG, WebP, AVIF and KTX2", file_,
                                  printable(file.name.empty() ? file.path.string() : file.name)));
        return -1;
    }
    found->second = int(image_list_.size());
    Json json = {{"bufferView", buffer_.add_view(bytes.data(), bytes.size(), GlbBuffer::Use::anything)},
                 {"mimeType", mime}};
    if (!file.name.empty()) json["name"] = file.name;
    image_list_.push_back(std::move(json));
    return found->second;
}

int GlbMaterials::sampler(const Texture& t)
{
    const auto [found, is_new] = samplers_.try_emplace({t.wrap_u, t.wrap_v, t.nearest}, int(sampler_list_.size()));
    if (is_new)
        sampler_list_.push_back({{"magFilter", t.nearest ? 9728 : 9729},
                                 {"minFilter", t.nearest ? 9728 : 9987},
                                 {"wrapS", wrap_mode(t.wrap_u)},
                                 {"wrapT", wrap_mode(t.wrap_v)}});
    return found->second;
}

}  // namespace fathom
