#include "compile/images.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>

#include "fathom/error.h"
#include "fathom/memory.h"

namespace fathom {

namespace {

/// sRGB to linear: IEC 61966-2-1. In double, so that all math libraries round to the same float.
float linear_from_srgb(double v)
{
    return float(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
}

/// Where red, green, blue and alpha are in a pixel; grey pictures have one channel for three. alpha may be -1.
struct Channels {
    int rgba[4];

    explicit Channels(const Image::Layer& layer)
    {
        const auto position = [&](const char* name) {
            const auto found = std::find(layer.channels.begin(), layer.channels.end(), name);
            return found == layer.channels.end() ? -1 : int(found - layer.channels.begin());
        };
        const int grey = position("Y");
        const char* const names[4] = {"R", "G", "B", "A"};
        for (int i = 0; i < 4; ++i) rgba[i] = position(names[i]);
        for (int i = 0; i < 3; ++i)
            if (rgba[i] < 0) rgba[i] = std::max(grey, 0);
    }
    float of(const float* pixel, int i) const { return rgba[i] >= 0 ? pixel[rgba[i]] : 1; }
};

/// The integer from 0 to `most` that stands for v, if v is just that over `most`; else -1.
int code_of(float v, int most)
{
    if (!(v >= 0 && v <= 1)) return -1;
    const int code = int(std::lrint(v * float(most)));
    return float(code) / float(most) == v ? code : -1;
}

/// The half that is v, if there is one and it is finite; else -1.
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

}  // namespace

ImageStore::ImageStore(Compiler& c) : c_(c)
{
    for (int code = 0; code < 256; ++code) c.tables.linear_of_srgb[std::size_t(code)] = linear_from_srgb(code / 255.0);
}

ImageStore::Texels ImageStore::texture(int image, ColorSpace space)
{
    const auto [place, fresh] = textures_.try_emplace({image, space});
    if (fresh) place->second = read(image, space, true);
    return place->second;
}

ImageStore::Texels ImageStore::environment(int image) { return read(image, ColorSpace::srgb, false); }

ImageStore::Texels ImageStore::read(int index, ColorSpace space, bool may_pack)
{
    const ImageFile& file = c_.scene.images[std::size_t(index)];
    Image image;
    try {
        image = file.bytes.empty() ? read_image(file.path) : read_image(file.name, file.bytes.data(), file.bytes.size());
    } catch (const Error& error) {
        c_.warnings.add(fmt::format("{}; grey is used instead", error.what()));
        image = {};
        image.width = image.height = 1;
        image.is_linear = true;
        image.layers.push_back({"", {"Y"}, {0.5f}});
    }
    const bool decode = space == ColorSpace::srgb && !image.is_linear;
    if (may_pack) {
        // Integers of 16 bits in sRGB would need a table that is too large for caches; they become floats.
        const TexelFormat narrow = decode ? TexelFormat::bytes_srgb : TexelFormat::bytes;
        for (const TexelFormat format : {narrow, image.is_linear ? TexelFormat::halves : TexelFormat::shorts}) {
            if ((decode && format == TexelFormat::shorts) || !pack(image, format)) continue;
            return {format, c_.tables.packed_images.size() - 1, image.width, image.height};
        }
    }
    return {TexelFormat::float4, append_floats(image, decode), image.width, image.height};
}

/// Adds a packed image, unless the format can't hold one of the values.
bool ImageStore::pack(const Image& image, TexelFormat format)
{
    const Image::Layer& layer = image.layers.front();
    const Channels places(layer);
    const std::size_t stride = layer.channels.size(), pixels = std::size_t(image.width) * std::size_t(image.height);
    const bool in_bytes = format == TexelFormat::bytes || format == TexelFormat::bytes_srgb;
    const std::size_t words_per_texel = in_bytes ? 1 : 2;
    check_memory(double(pixels * words_per_texel) * 4);
    std::vector<std::uint32_t> words(pixels * words_per_texel);
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < 4; ++k) {
            const int code = encoded(places.of(&layer.pixels[i * stride], k), format);
            if (code < 0) return false;
            if (in_bytes)
                words[i] |= std::uint32_t(code) << (8 * k);
            else
                words[2 * i + std::size_t(k / 2)] |= std::uint32_t(code) << (16 * (k % 2));
        }
    c_.tables.packed_images.push_back(std::move(words));
    return true;
}

std::uint64_t ImageStore::append_floats(const Image& image, bool decode)
{
    const Image::Layer& layer = image.layers.front();
    const Channels places(layer);
    const std::size_t stride = layer.channels.size(), pixels = std::size_t(image.width) * std::size_t(image.height);
    std::vector<float>& texels = c_.tables.texels;
    const std::size_t first = texels.size() / 4;
    // Growing keeps the old texels until they are copied.
    check_memory(double(first + pixels) * 16);
    texels.resize((first + pixels) * 4);
    for (std::size_t i = 0; i < pixels; ++i)
        for (int k = 0; k < 4; ++k) {
            const float v = places.of(&layer.pixels[i * stride], k);
            texels[(first + i) * 4 + std::size_t(k)] = decode && k < 3 ? linear_from_srgb(double(v)) : v;
        }
    return first;
}

void ImageStore::check_memory(double bytes) const
{
    if (const double available = double(available_memory_bytes()); bytes > available)
        throw Error(c_.scene.file, "",
                    fmt::format("its textures need {:.1f} GB more of memory, {:.1f} GB are there", bytes / 1e9, available / 1e9));
}

}  // namespace fathom
