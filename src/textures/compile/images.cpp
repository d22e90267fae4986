// SPDX-License-Identifier: Apache-2.0
#include "textures/compile/images.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <optional>
#include <set>
#include <utility>

#include "fathom/error.h"
#include "fathom/memory.h"
#include "image/color/primaries.h"
#include "image/picture.h"
#include "image/projections/equal_area_map.h"

namespace fathom {

namespace {

/// Converts sRGB to linear: IEC 61966-2-1. In double precision all math libraries round to the same float.
float linear_from_srgb(double v)
{
    return float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

/// Positions of red, green, blue and alpha in a pixel. Gray images have one channel for all three colors; -1: no alpha.
struct Channels {
    int rgba[4];

    explicit Channels(const Image::Layer& layer)
    {
        const auto position = [&](const char* name) {
            const auto found = std::find(layer.channels.begin(), layer.channels.end(), name);
            return found == layer.channels.end() ? -1 : int(found - layer.channels.begin());
        };
        const int gray = position("Y");
        const char* const names[4] = {"R", "G", "B", "A"};
        for (int i = 0; i < 4; ++i) rgba[i] = position(names[i]);
        for (int i = 0; i < 3; ++i)
            if (rgba[i] < 0) rgba[i] = std::max(gray, 0);
    }
    float of(const float* pixel, int i) const { return rgba[i] >= 0 ? pixel[rgba[i]] : 1; }
};

/// The integer code in [0, most] whose quotient code / most equals v exactly; -1 if there is none.
int code_of(float v, int most)
{
    if (!(v >= 0 && v <= 1)) return -1;
    const int code = int(std::lrint(v * float(most)));
    return float(code) / float(most) == v ? code : -1;
}

/// The finite half that equals v, as bits; -1 if there is none.
int half_of(float v)
{
    const std::uint32_t magnitude = std::bit_cast<std::uint32_t>(std::abs(v) * 0x1p-112f);
    const std::uint32_t half = magnitude >> 13;
    if (half >= 0x7c00 || std::bit_cast<float>(half << 13) * 0x1p112f != std::abs(v)) return -1;
    return int(half | std::bit_cast<std::uint32_t>(v) >> 31 << 15);
}

int encoded(float v, TexelFormat format)
{
    switch (format) {
        case TexelFormat::bytes:
        case TexelFormat::bytes_srgb:
            return code_of(v, 255);
        case TexelFormat::shorts:
            return code_of(v, 65535);
        case TexelFormat::halves:
            return half_of(v);
        case TexelFormat::float4:
            break;
    }
    return -1;
}

/// An image as the tables store it: `words` if a narrow format holds it exactly, else `floats`.
struct Decoded {
    TexelFormat format = TexelFormat::float4;
    int width = 0, height = 0;
    std::vector<std::uint32_t> words;
    LargeVector<float> floats;
    std::size_t non_finite = 0;  ///< number of NaN or infinite values, which became 0
};

/// Reads images; each step uses at most a given fraction of the available memory.
class Decoder {
public:
    /// parts: the allowed fraction of the memory is 1 / parts
    Decoder(const SceneDescription& scene, std::uint64_t parts) : scene_(scene), parts_(parts) {}

    /// Reads an image. Throws Error; if a file can't be read, the error names it.
    Picture read(int index) const
    {
        const ImageFile& file = scene_.images[std::size_t(index)];
        return file.bytes.empty() ? read_picture(file.path, available())
                                  : read_picture(file.name, file.bytes.data(), file.bytes.size(), available());
    }

    /// Converts an image. Images of 8 bits are moved unchanged, unless they serve as environment, light or height map.
    Decoded texels(Picture&& picture, const ImageUse& use) const
    {
        auto* const bytes = std::get_if<ByteImage>(&picture);
        if (!bytes) return texels(std::get<Image>(picture), use);
        if (use.purpose != ImageUse::Purpose::texture || use.height_scale != 0) {
            return texels(to_image(*bytes, name_of(scene_, use.image), available()), use);
        }
        const TexelFormat format = use.space == ColorSpace::srgb ? TexelFormat::bytes_srgb : TexelFormat::bytes;
        return {format, bytes->width, bytes->height, std::move(bytes->texels), {}, 0};
    }

    Decoded texels(const Image& picture, const ImageUse& use) const
    {
        const bool is_color = use.space == ColorSpace::srgb && use.height_scale == 0;
        if (is_color && picture.chromaticities && !is_same(*picture.chromaticities, rec709_chromaticities))
            return texels(in_rec709(picture), use);
        const Image normals = use.height_scale != 0 ? normal_map(picture, use.height_scale) : Image();
        const Image& image = use.height_scale != 0 ? normals : picture;
        const ColorSpace space = use.height_scale != 0 ? ColorSpace::linear : use.space;
        const bool may_pack = use.purpose == ImageUse::Purpose::texture;
        Decoded decoded;
        decoded.width = image.width;
        decoded.height = image.height;
        const bool decode = space == ColorSpace::srgb && !image.is_linear;
        if (may_pack) {
            // Images with 16-bit sRGB codes become floats, since their decoding table would be too large for caches.
            const TexelFormat narrow = decode ? TexelFormat::bytes_srgb : TexelFormat::bytes;
            for (const TexelFormat format : {narrow, image.is_linear ? TexelFormat::halves : TexelFormat::shorts}) {
                if ((decode && format == TexelFormat::shorts) || !pack(image, format, decoded.words)) continue;
                decoded.format = format;
                return decoded;
            }
        }
        decoded.non_finite = unpack(image, decode, decoded.floats);
        return decoded;
    }

    /// Throws Error if fewer bytes are available.
    void check_memory(double bytes) const
    {
        if (bytes > double(available()))
            throw Error(
                scene_.file, "",
                fmt::format("its textures need {:.1f} GB more memory, {}", bytes / 1e9, available_memory_text()));
    }

private:
    Image in_rec709(const Image& picture) const
    {
        check_memory(double(sizeof(float)) * double(picture.layers.front().pixels.size()));
        Image image;
        image.width = picture.width;
        image.height = picture.height;
        image.is_linear = picture.is_linear;
        image.layers = {picture.layers.front()};
        convert(image.layers[0], conversion(picture.chromaticities.value(), rec709_chromaticities));
        return image;
    }

    /// Normal map of a height map, whose first channel is the height; edges wrap. Components are rounded to 16 bits,
    /// which format shorts stores exactly.
    Image normal_map(const Image& heights, float scale) const
    {
        const Image::Layer& layer = heights.layers.front();
        const int channel = std::max(Channels(layer).rgba[0], 0);
        const std::size_t stride = layer.channels.size();
        check_memory(12.0 * heights.width * heights.height);
        Image normals;
        normals.width = heights.width;
        normals.height = heights.height;
        normals.layers.push_back({"", {"R", "G", "B"}, {}});
        normals.layers[0].pixels.reserve(3 * std::size_t(heights.width) * std::size_t(heights.height));
        const auto at = [&](int x, int y) {
            const std::size_t column = std::size_t((x + heights.width) % heights.width);
            const std::size_t row = std::size_t((y + heights.height) % heights.height);
            return double(layer.pixels[(row * std::size_t(heights.width) + column) * stride + std::size_t(channel)]);
        };
        // Pixels are square. The second component of a normal map points up in the image.
        const double slope = 0.5 * double(scale) * heights.width;
        for (int y = 0; y < heights.height; ++y)
            for (int x = 0; x < heights.width; ++x) {
                const Vec3d n =
                    normalize(Vec3d{-slope * (at(x + 1, y) - at(x - 1, y)), slope * (at(x, y + 1) - at(x, y - 1)), 1});
                for (const double c : {n.x, n.y, n.z})
                    normals.layers[0].pixels.push_back(float(std::lrint((0.5 + 0.5 * c) * 65535)) / 65535);
            }
        return normals;
    }

    std::uint64_t available() const { return available_memory_bytes() / parts_; }

    /// Returns false if the format can't hold one of the values exactly.
    bool pack(const Image& image, TexelFormat format, std::vector<std::uint32_t>& words) const
    {
        const Image::Layer& layer = image.layers.front();
        const Channels places(layer);
        const std::size_t stride = layer.channels.size(), pixels = std::size_t(image.width) * std::size_t(image.height);
        const bool in_bytes = format == TexelFormat::bytes || format == TexelFormat::bytes_srgb;
        const std::size_t words_per_texel = in_bytes ? 1 : 2;
        check_memory(double(pixels * words_per_texel) * 4);
        words.assign(pixels * words_per_texel, 0);
        for (std::size_t i = 0; i < pixels; ++i)
            for (int k = 0; k < 4; ++k) {
                const int code = encoded(places.of(&layer.pixels[i * stride], k), format);
                if (code < 0) {
                    words = {};
                    return false;
                }
                if (in_bytes)
                    words[i] |= std::uint32_t(code) << (8 * k);
                else
                    words[2 * i + std::size_t(k / 2)] |= std::uint32_t(code) << (16 * (k % 2));
            }
        return true;
    }

    /// Stores the values as floats and returns the number of NaN or infinite ones, which become 0. A single one would
    /// invalidate the sums by which environments are sampled, and every sample to which it contributes.
    std::size_t unpack(const Image& image, bool decode, LargeVector<float>& texels) const
    {
        const Image::Layer& layer = image.layers.front();
        const Channels places(layer);
        const std::size_t stride = layer.channels.size(), pixels = std::size_t(image.width) * std::size_t(image.height);
        check_memory(double(pixels) * 16);
        texels.resize(pixels * 4);
        std::size_t non_finite = 0;
        for (std::size_t i = 0; i < pixels; ++i)
            for (int k = 0; k < 4; ++k) {
                float v = places.of(&layer.pixels[i * stride], k);
                if (!std::isfinite(v)) v = 0, ++non_finite;
                texels[i * 4 + std::size_t(k)] = decode && k < 3 ? linear_from_srgb(double(v)) : v;
            }
        return non_finite;
    }

    const SceneDescription& scene_;
    std::uint64_t parts_;
};

ImageUse use_of(const Texture& texture)
{
    return {texture.image, texture.color_space, texture.height_scale, ImageUse::Purpose::texture};
}
ImageUse environment_use(int image)
{
    return {image, ColorSpace::srgb, 0, ImageUse::Purpose::environment};
}

/// All image uses without repetition, in the order of their warnings and texels.
std::vector<ImageUse> uses_of(const SceneDescription& scene)
{
    std::vector<ImageUse> uses;
    std::set<ImageUse> seen;
    const auto add = [&](const ImageUse& use) {
        if (use.image >= 0 && seen.insert(use).second) uses.push_back(use);
    };
    for (const Texture& texture : scene.textures)
        if (texture.kind == TextureKind::image) add(use_of(texture));
    if (scene.environment.kind == EnvironmentKind::image || scene.environment.kind == EnvironmentKind::equal_area)
        add(environment_use(scene.environment.image));
    if (scene.environment.kind == EnvironmentKind::cube)
        for (const int face : scene.environment.faces) add(environment_use(face));
    for (const Light& light : scene.lights)
        if (is_pictured(light) && !is_profile(scene, light.picture.image))
            add({light.picture.image, light.picture.color_space, 0, ImageUse::Purpose::light});
    return uses;
}

Image gray()
{
    Image image;
    image.width = image.height = 1;
    image.is_linear = true;
    image.layers.push_back({"", {"Y"}, {0.5f}});
    return image;
}

std::optional<Decoded> try_to_decode(const Decoder& decoder, const ImageUse& use)
{
    try {
        return decoder.texels(decoder.read(use.image), use);
    } catch (const Error&) {
        return std::nullopt;
    } catch (const std::bad_alloc&) {
        return std::nullopt;
    }
}

/// Decodes the images that are missing in `decoded` on several threads. Images that fail stay empty: they are damaged,
/// or too large for the thread's share of the memory.
void decode_together(const SceneDescription& scene, const std::vector<ImageUse>& uses, int threads,
                     std::vector<std::optional<Decoded>>& decoded)
{
    // Each thread checks available memory before it allocates, unaware of the others' checks. It asks for the file's
    // bytes, the values and up to two formats; the factor 4 keeps the sum within the available memory.
    const Decoder decoder(scene, 4 * std::uint64_t(threads));
    const auto decode = [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
            if (!decoded[i]) decoded[i] = try_to_decode(decoder, uses[i]);
    };
    tbb::task_arena(threads).execute([&] {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, uses.size(), 1), decode, tbb::simple_partitioner());
    });
}

/// Decodes an image with all available memory, so that results and warnings don't depend on the number of threads.
Decoded decode_alone(const Compiler& c, const ImageUse& use)
{
    const Decoder decoder(c.scene, 1);
    Picture picture = gray();
    try {
        picture = decoder.read(use.image);
    } catch (const Error& error) {
        c.warnings.add(fmt::format("{}; gray is used instead", error.what()));
    }
    return decoder.texels(std::move(picture), use);
}

}  // namespace

std::string name_of(const SceneDescription& scene, int image)
{
    const ImageFile& file = scene.images[std::size_t(image)];
    return file.bytes.empty() ? file.path.string() : file.name;
}

ImageStore::ImageStore(Compiler& c)
{
    for (int code = 0; code < 256; ++code) c.tables.linear_of_srgb[std::size_t(code)] = linear_from_srgb(code / 255.0);

    const std::vector<ImageUse> uses = uses_of(c.scene);
    std::vector<std::optional<Decoded>> decoded(uses.size());
    // Repeats with fewer threads, and thus larger memory shares, until all images are decoded or one thread is left.
    const std::size_t most = std::size_t(tbb::this_task_arena::max_concurrency());
    for (int threads = int(std::min(most, uses.size())); threads > 1; threads /= 4)
        decode_together(c.scene, uses, threads, decoded);
    std::vector<Decoded> pictures;
    std::size_t floats = 0;
    for (std::size_t i = 0; i < uses.size(); ++i) {
        std::optional<Decoded>& picture = decoded[i];
        pictures.push_back(picture ? std::move(*picture) : decode_alone(c, uses[i]));
        if (uses[i].purpose == ImageUse::Purpose::texture) floats += pictures.back().floats.size();
    }
    Decoder(c.scene, 1).check_memory(double(floats) * sizeof(float));
    c.tables.texels.reserve(floats);
    for (std::size_t i = 0; i < uses.size(); ++i) {
        Decoded d = std::move(pictures[i]);  // moving frees the floats of each image once they are in the tables
        c.warnings.add(fmt::format("{}: values that are not finite are replaced by 0", name_of(c.scene, uses[i].image)),
                       d.non_finite);
        Texels& texels = texels_[uses[i]];
        texels = {d.format, c.tables.packed_images.size(), d.width, d.height};
        if (uses[i].purpose == ImageUse::Purpose::light) {
            lights_[{uses[i].image, uses[i].space}] = {d.width, d.height, std::move(d.floats)};
        } else if (uses[i].purpose == ImageUse::Purpose::environment) {
            environment_[uses[i].image] = {d.width, d.height, std::move(d.floats)};
        } else if (d.format != TexelFormat::float4) {
            c.tables.packed_images.push_back(std::move(d.words));
        } else {
            texels.place = c.tables.texels.size() / 4;
            c.tables.texels.insert(c.tables.texels.end(), d.floats.begin(), d.floats.end());
        }
    }
}

ImageStore::Texels ImageStore::texture(const Texture& texture) const
{
    return texels_.at(use_of(texture));
}

void ImageStore::set_lights(Compiler& c)
{
    c.light_images.by_use.clear();
    for (const Light& light : c.scene.lights) {
        const LightImages::Use use{light.picture.image, light.picture.color_space};
        if (!is_pictured(light) || c.light_images.by_use.contains(use)) continue;
        if (use.first < 0) {
            add_light_image(c, use, 1, 1, {1, 1, 1, 1});
        } else if (is_profile(c.scene, use.first)) {
            add_light_profile(c, use);
        } else {
            const CubeFace picture = std::move(lights_.at(use));
            Decoder(c.scene, 1).check_memory(16.0 * picture.width * picture.height);
            add_light_image(c, use, picture.width, picture.height, picture.texels);
        }
    }
}

void ImageStore::set_environment(Compiler& c)
{
    const Environment& e = c.scene.environment;
    EnvironmentRecord& t = c.tables.environment;
    if (e.kind == EnvironmentKind::image && e.image >= 0) {
        CubeFace& picture = environment_.at(e.image);
        t.width = picture.width, t.height = picture.height;
        t.texels = std::move(picture.texels);
    }
    if (e.kind == EnvironmentKind::equal_area && e.image >= 0) {
        const CubeFace& square = environment_.at(e.image);
        if (square.width != square.height)
            throw Error(c.scene.images[std::size_t(e.image)].name, "",
                        fmt::format("an equal-area environment image must be square: this one has {} by {} pixels",
                                    square.width, square.height));
        t.width = equirectangular_width(square), t.height = square.width;
        Decoder(c.scene, 1).check_memory(16.0 * t.width * t.height);
        t.texels = equirectangular_from_equal_area(square);
    }
    if (e.kind != EnvironmentKind::cube) return;
    std::array<CubeFace, 6> faces;
    for (std::size_t i = 0; i < faces.size(); ++i)
        faces[i] = e.faces[i] >= 0 ? environment_.at(e.faces[i]) : CubeFace{1, 1, {0, 0, 0, 1}};
    t.width = equirectangular_width(faces), t.height = t.width / 2;
    Decoder(c.scene, 1).check_memory(16.0 * t.width * t.height);
    t.texels = equirectangular(faces);
}

}  // namespace fathom
