// SPDX-License-Identifier: Apache-2.0
#include "image/codecs/exr_parts.h"

#include <ImfChannelList.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/machine.h"
#include "fathom/error.h"
#include "image/color/primaries.h"

namespace fathom {

namespace {

/// Whether a layer may be stored as half floats: only colors within half's range. Ids, distances and variances would
/// lose precision: half has 11 significant bits and nothing below 6e-8.
bool fits_half(const Image::Layer& layer)
{
    constexpr float largest_half = 65504;
    return layer.is_color() && std::none_of(layer.pixels.begin(), layer.pixels.end(),
                                            [](float v) { return std::abs(v) > largest_half && !std::isinf(v); });
}

/// Bytes that OpenEXR reads of an attribute of this type, whatever its stated length; 0 if it reads the stated length.
std::size_t fixed_size(std::string_view type)
{
    constexpr std::pair<std::string_view, std::size_t> sizes[] = {{"box2f", 16},
                                                                  {"box2i", 16},
                                                                  {"chromaticities", 32},
                                                                  {"compression", 1},
                                                                  {"deepImageState", 1},
                                                                  {"double", 8},
                                                                  {"envmap", 1},
                                                                  {"float", 4},
                                                                  {"int", 4},
                                                                  {"keycode", 28},
                                                                  {"lineOrder", 1},
                                                                  {"m33d", 72},
                                                                  {"m33f", 36},
                                                                  {"m44d", 128},
                                                                  {"m44f", 64},
                                                                  {"rational", 8},
                                                                  {"tiledesc", 9},
                                                                  {"timecode", 8},
                                                                  {"v2d", 16},
                                                                  {"v2f", 8},
                                                                  {"v2i", 8},
                                                                  {"v3d", 24},
                                                                  {"v3f", 12},
                                                                  {"v3i", 12}};
    for (const auto& [name, size] : sizes)
        if (name == type) return size;
    return 0;
}

/// Whether these bytes are exactly a channel list, which ends with an empty name.
bool is_channel_list(std::string_view bytes)
{
    constexpr std::size_t after_name = 16;
    while (!bytes.empty() && bytes[0] != 0) {
        const std::size_t name = bytes.find('\0');
        if (name == std::string_view::npos || bytes.size() - name - 1 < after_name) return false;
        bytes.remove_prefix(name + 1 + after_name);
    }
    return bytes.size() == 1;
}

/// Layers converted to other primaries. Variances and standard errors are kept, since those of mixed channels don't
/// follow from those of the channels.
std::vector<Image::Layer> converted_layers(const Image& image, const Chromaticities& primaries)
{
    const ColorMatrix matrix = conversion(rec709_chromaticities, primaries);
    std::vector<Image::Layer> layers = image.layers;
    for (Image::Layer& layer : layers)
        if (layer.is_color()) convert(layer, matrix);
    return layers;
}

void add_chromaticities(Imf::Header& header, const Chromaticities& c)
{
    const auto point = [](Vec2f v) { return Imath::V2f(v.x, v.y); };
    Imf::addChromaticities(header, Imf::Chromaticities(point(c.red), point(c.green), point(c.blue), point(c.white)));
}

}  // namespace

std::string full_name(const std::string& layer, const std::string& channel)
{
    return layer.empty() ? channel : layer + "." + channel;
}

std::optional<std::size_t> exr_headers_end(const unsigned char* bytes, std::size_t size)
{
    const char* const characters = reinterpret_cast<const char*>(bytes);
    std::size_t at = 8;
    // Moves behind the terminating zero of the string at this position.
    const auto skip_word = [&] {
        const auto* end = at < size ? std::memchr(bytes + at, 0, size - at) : nullptr;
        if (end) at = std::size_t(static_cast<const unsigned char*>(end) - bytes) + 1;
        return end != nullptr;
    };
    if (size < at) return {};
    const bool has_parts = bytes[5] & 0x10;
    do {
        while (at < size && bytes[at] != 0) {
            if (!skip_word()) return {};  // attribute name
            const std::size_t type_at = at;
            if (!skip_word()) return {};
            const std::string_view type(characters + type_at, at - type_at - 1);
            std::uint32_t length = 0;
            if (size - at < 4) return {};
            for (int i = 3; i >= 0; --i) length = length << 8 | bytes[at + std::size_t(i)];
            at += 4;
            if (length > size - at) return {};
            if (fixed_size(type) > 0 && length != fixed_size(type)) return {};
            if (type == "chlist" && !is_channel_list({characters + at, length})) return {};
            at += length;
        }
        if (++at >= size) return {};
        // The header list of multi-part files ends with an empty header.
    } while (has_parts && bytes[at] != 0);
    return at;
}

bool ExrMemoryInput::read(char destination[], int size)
{
    if (size < 0 || std::size_t(size) > file_.size - position_)
        throw Error(file_.name, "", "the file is truncated or damaged");
    std::memcpy(destination, file_.bytes + position_, std::size_t(size));
    position_ += std::size_t(size);
    return position_ < file_.size;
}

void ExrMemoryInput::seekg(std::uint64_t position)
{
    position_ = std::min<std::uint64_t>(position, file_.size);
}

std::vector<Imf::Header> read_exr_headers(const EncodedImage& file)
{
    ExrMemoryInput stream(file);
    char start[8];  // magic number, then version and flags, little-endian
    stream.read(start, sizeof start);
    int version = 0;
    for (int i = 7; i >= 4; --i) version = version << 8 | static_cast<unsigned char>(start[i]);
    const bool has_parts = version & 0x1000;
    std::vector<Imf::Header> headers;
    do {
        headers.emplace_back().readFrom(stream, version);
        // The header list of multi-part files ends with an empty header.
    } while (has_parts && stream.tellg() < file.size && file.bytes[stream.tellg()] != 0);
    return headers;
}

Imf::Header read_exr_header(const EncodedImage& file)
{
    return read_exr_headers(file).front();
}

int exr_threads()
{
    // OpenEXR's thread pool belongs to the process: a host program that has set it up keeps its choice. The pool is set
    // once, because several threads read images and it must not change while one of them uses it.
    static const int threads = [] {
        if (Imf::globalThreadCount() == 0)
            Imf::setGlobalThreadCount(startable_threads(1 + std::min(usable_cores("/"), 4)) - 1);
        return Imf::globalThreadCount();
    }();
    return threads;
}

ExrChannels::ExrChannels(const Image& image, const WriteOptions& options) : header(image.width, image.height)
{
    for (const auto& [name, value] : image.attributes) header.insert(name, Imf::StringAttribute(value));
    const bool is_converted = options.exr_primaries != Primaries::rec709;  // files without the attribute have Rec.709
                                                                           // primaries
    if (is_converted) {
        const Chromaticities primaries = chromaticities_of(options.exr_primaries);
        converted_ = converted_layers(image, primaries);
        add_chromaticities(header, primaries);
    }
    for (const Image::Layer& layer : is_converted ? converted_ : image.layers) {
        const std::size_t count = layer.channels.size();
        const bool as_half = options.exr_half && fits_half(layer);
        if (as_half) halves_.emplace_back(layer.pixels.begin(), layer.pixels.end());
        for (std::size_t c = 0; c < count; ++c) {
            const std::string name = full_name(layer.name, layer.channels[c]);
            if (as_half)
                add(name, Imf::HALF, halves_.back().data() + c, count * sizeof(half));
            else
                add(name, Imf::FLOAT, layer.pixels.data() + c, count * sizeof(float));
        }
    }
    for (const Image::UintChannel& channel : image.uint_channels)
        add(channel.name, Imf::UINT, channel.values.data(), sizeof(std::uint32_t));
}

void ExrChannels::add(const std::string& name, Imf::PixelType type, const void* first, std::size_t stride)
{
    header.channels().insert(name, Imf::Channel(type));
    channels.push_back({name, type, static_cast<const char*>(first), stride});
}

}  // namespace fathom
