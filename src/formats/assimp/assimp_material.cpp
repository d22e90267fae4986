// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "formats/assimp/assimp_convert.h"
#include "formats/common/phong.h"

namespace fathom {

namespace {

Color color_or(const aiMaterial& m, const char* key, unsigned type, unsigned index, Color otherwise)
{
    aiColor3D c;
    if (m.Get(key, type, index, c) != aiReturn_SUCCESS) return otherwise;
    const auto channel = [](float x) { return std::isfinite(x) && x > 0 ? x : 0.0f; };
    return {channel(c.r), channel(c.g), channel(c.b)};
}

std::optional<float> number(const aiMaterial& m, const char* key, unsigned type, unsigned index)
{
    float x = 0;
    if (m.Get(key, type, index, x) != aiReturn_SUCCESS || !std::isfinite(x)) return std::nullopt;
    return x;
}

Wrap to_wrap(int mode)
{
    if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal) return Wrap::clamp;
    return mode == aiTextureMapMode_Mirror ? Wrap::mirror : Wrap::repeat;
}

/// Whether an image may have an alpha channel, judged by its extension alone.
bool may_have_alpha(const std::string& path)
{
    std::string lower = path;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    return !lower.ends_with(".jpg") && !lower.ends_with(".jpeg") && !lower.ends_with(".bmp");
}

}  // namespace

bool AssimpConverter::read_embedded(const aiTexture& from, ImageFile& image)
{
    const auto append = [&](const void* data, std::size_t size) {
        const auto* bytes = static_cast<const std::byte*>(data);
        image.bytes.insert(image.bytes.end(), bytes, bytes + size);
    };
    if (from.mHeight == 0) {  // mWidth bytes of an encoded image file
        append(from.pcData, from.mWidth);
        return !image.bytes.empty();
    }
    if (from.mWidth > 65535 || from.mHeight > 65535) return false;
    // Uncompressed BGRA becomes a TGA file, which has these bytes behind a header; 0x28 means rows from the top and 8
    // bits of alpha.
    const auto low = [](unsigned x) { return static_cast<unsigned char>(x & 255); };
    const unsigned w = from.mWidth, h = from.mHeight;
    const unsigned char header[18] = {0, 0, 2, 0,      0,           0,      0,           0,  0,
                                      0, 0, 0, low(w), low(w >> 8), low(h), low(h >> 8), 32, 0x28};
    append(header, sizeof header);
    append(from.pcData, std::size_t(w) * h * sizeof(aiTexel));
    return true;
}

int AssimpConverter::image(const std::string& path)
{
    const auto [found, is_new] = images_.try_emplace(path, -1);
    if (!is_new) return found->second;
    ImageFile image;
    image.name = path;
    if (const aiTexture* embedded = from_.GetEmbeddedTexture(path.c_str())) {
        if (!read_embedded(*embedded, image)) {
            warn("an embedded texture can't be read and is ignored");
            return -1;
        }
    } else {
        std::string clean = path;
        std::replace(clean.begin(), clean.end(), '\\', '/');
        const std::filesystem::path folder = file_.parent_path();
        image.path = folder / clean;
        // Absolute paths often refer to the machine that exported the file; the image is then looked for beside the
        // file.
        std::error_code error;
        if (!std::filesystem::exists(image.path, error)) {
            const std::filesystem::path beside = folder / std::filesystem::path(clean).filename();
            if (std::filesystem::exists(beside, error)) image.path = beside;
        }
    }
    found->second = int(to_.images.size());
    to_.images.push_back(std::move(image));
    return found->second;
}

int AssimpConverter::texture(const aiMaterial& material, aiTextureType type, ColorSpace color_space, unsigned index)
{
    if (material.GetTextureCount(type) <= index) return -1;
    aiString path;
    unsigned uv_set = 0;
    aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (material.GetTexture(type, index, &path, nullptr, &uv_set, nullptr, nullptr, modes) != aiReturn_SUCCESS ||
        path.length == 0)
        return -1;
    Texture texture;
    texture.image = image(path.C_Str());
    if (texture.image < 0) return -1;
    texture.name = path.C_Str();
    texture.color_space = color_space;
    texture.uv_set = uv_set <= 1 ? int(uv_set) : 0;
    texture.wrap_u = to_wrap(modes[0]);
    texture.wrap_v = to_wrap(modes[1]);
    to_.textures.push_back(std::move(texture));
    return int(to_.textures.size()) - 1;
}

/// Reads the keys of physically based materials, which override the older keys. Assimp names them uniformly for all
/// formats.
void AssimpConverter::add_layers(const aiMaterial& from, Color diffuse, Material& m)
{
    const auto share = [&](const char* key, unsigned type, unsigned index, float otherwise) {
        return std::clamp(number(from, key, type, index).value_or(otherwise), 0.0f, 1.0f);
    };
    const auto map = [&](aiTextureType type, unsigned index) { return texture(from, type, ColorSpace::linear, index); };
    const auto bounded = [](Color c) { return Color{std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)}; };
    const int roughness_map = map(aiTextureType_DIFFUSE_ROUGHNESS, 0), metallic_map = map(aiTextureType_METALNESS, 0);
    const bool has_metal = number(from, AI_MATKEY_ROUGHNESS_FACTOR) || number(from, AI_MATKEY_METALLIC_FACTOR) ||
                           roughness_map >= 0 || metallic_map >= 0;
    const Color sheen = bounded(color_or(from, AI_MATKEY_SHEEN_COLOR_FACTOR, {0, 0, 0}));
    const float coat = share(AI_MATKEY_CLEARCOAT_FACTOR, 0), transmission = share(AI_MATKEY_TRANSMISSION_FACTOR, 0);
    const float anisotropy = share(AI_MATKEY_ANISOTROPY_FACTOR, 0);
    if (!has_metal && !(coat > 0) && !(transmission > 0) && !(anisotropy > 0) && sheen == Color{0, 0, 0}) return;
    m.kind = MaterialKind::principled;
    m.base_color.value = bounded(color_or(from, AI_MATKEY_BASE_COLOR, diffuse));
    // By convention of many formats, a packed texture has roughness in green and metallic in blue.
    const bool packed = roughness_map >= 0 && metallic_map >= 0 &&
                        to_.textures[std::size_t(roughness_map)].image == to_.textures[std::size_t(metallic_map)].image;
    if (has_metal) {
        m.roughness = {share(AI_MATKEY_ROUGHNESS_FACTOR, roughness_map >= 0 ? 1 : 0.5f), roughness_map, packed ? 1 : 0};
        m.metallic = {share(AI_MATKEY_METALLIC_FACTOR, metallic_map >= 0 ? 1 : 0), metallic_map, packed ? 2 : 0};
    }
    m.microfacets.anisotropy.value = anisotropy;
    m.coat.weight = {coat, map(aiTextureType_CLEARCOAT, 0), 0};
    m.coat.roughness = {share(AI_MATKEY_CLEARCOAT_ROUGHNESS_FACTOR, 0), map(aiTextureType_CLEARCOAT, 1), 1};
    m.coat.normal_texture = map(aiTextureType_CLEARCOAT, 2);
    m.sheen.color = {sheen, texture(from, aiTextureType_SHEEN, ColorSpace::srgb, 0)};
    m.sheen.roughness.value = share(AI_MATKEY_SHEEN_ROUGHNESS_FACTOR, m.sheen.roughness.value);
    m.transmission.weight = {transmission, map(aiTextureType_TRANSMISSION, 0), 0};
    const float distance = number(from, AI_MATKEY_VOLUME_ATTENUATION_DISTANCE).value_or(0);
    m.interior.attenuation_distance = distance > 0 ? double(distance) : 0;
    m.interior.attenuation_color = bounded(color_or(from, AI_MATKEY_VOLUME_ATTENUATION_COLOR, {1, 1, 1}));
    m.interior.thin = transmission > 0 && !(number(from, AI_MATKEY_VOLUME_THICKNESS_FACTOR).value_or(0) > 0);
}

void AssimpConverter::add_material(const aiMaterial& from)
{
    Material m;
    m.name = from.GetName().C_Str();
    Phong phong;
    phong.diffuse = color_or(from, AI_MATKEY_COLOR_DIFFUSE, {0.8f, 0.8f, 0.8f});
    phong.specular = color_or(from, AI_MATKEY_COLOR_SPECULAR, {0, 0, 0});
    const float strength = number(from, AI_MATKEY_SHININESS_STRENGTH).value_or(1);
    phong.specular = {phong.specular.r * strength, phong.specular.g * strength, phong.specular.b * strength};
    phong.shininess = number(from, AI_MATKEY_SHININESS).value_or(0);
    phong.opacity = number(from, AI_MATKEY_OPACITY).value_or(1);
    phong.ior = number(from, AI_MATKEY_REFRACTI).value_or(1.5f);
    // An opacity of 0 usually means that the exporter wrote transparency instead, so the material counts as opaque.
    if (phong.opacity == 0) phong.opacity = 1;
    m.base_color.texture = texture(from, aiTextureType_BASE_COLOR, ColorSpace::srgb);
    if (m.base_color.texture < 0) m.base_color.texture = texture(from, aiTextureType_DIFFUSE, ColorSpace::srgb);
    if (m.base_color.texture >= 0 && phong.diffuse == Color{0, 0, 0}) phong.diffuse = {1, 1, 1};
    set_phong(m, phong);

    add_layers(from, phong.diffuse, m);
    m.emission.radiance.value = color_or(from, AI_MATKEY_COLOR_EMISSIVE, {0, 0, 0});
    m.emission.radiance.texture = texture(from, aiTextureType_EMISSIVE, ColorSpace::srgb);
    if (m.emission.radiance.texture >= 0 && m.emission.radiance.value == Color{0, 0, 0})
        m.emission.radiance.value = {1, 1, 1};
    const float intensity = std::max(number(from, AI_MATKEY_EMISSIVE_INTENSITY).value_or(1), 0.0f);
    for (float* c : {&m.emission.radiance.value.r, &m.emission.radiance.value.g, &m.emission.radiance.value.b})
        *c *= intensity;
    m.emission.two_sided = true;
    m.normal_map.texture = texture(from, aiTextureType_NORMALS, ColorSpace::linear);
    // Assimp's type HEIGHT stands for bump maps. The scale is FBX's, which has no name in Assimp's headers.
    if (const int heights = texture(from, aiTextureType_DISPLACEMENT, ColorSpace::linear); heights >= 0)
        m.displacement.height = {number(from, "$mat.displacementscaling", 0, 0).value_or(1), heights, 0};
    if (const int opacity = texture(from, aiTextureType_OPACITY, ColorSpace::linear); opacity >= 0) {
        const auto image_of = [&](int t) { return t >= 0 ? to_.textures[std::size_t(t)].image : -1; };
        const bool same = image_of(opacity) == image_of(m.base_color.texture);
        // If the opacity map is the color image, its alpha channel is meant.
        if (!same || may_have_alpha(to_.textures[std::size_t(opacity)].name)) {
            m.opacity.alpha.texture = opacity;
            m.opacity.alpha.channel = same ? 3 : 0;
            m.opacity.mode = AlphaMode::blend;
        }
    }
    to_.materials.push_back(std::move(m));
}

}  // namespace fathom
