// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>

#include "fathom/error.h"
#include "image/codecs/exr_luminance.h"
#include "image/codecs/exr_parts.h"
#include "image/color/primaries.h"

namespace fathom {

namespace {

/// Sort key of channels: R G B A X Y Z first, then all others by name.
int channel_rank(const std::string& channel)
{
    static const std::string order = "RGBAXYZ";
    return channel.size() == 1 && order.find(channel) != std::string::npos ? int(order.find(channel))
                                                                           : int(order.size());
}

std::pair<std::string, std::string> layer_and_channel(const std::string& name)
{
    const std::size_t dot = name.rfind('.');
    return dot == std::string::npos ? std::pair(std::string(), name)
                                    : std::pair(name.substr(0, dot), name.substr(dot + 1));
}

/// Color channels are read as float for any pixel type; other integer channels are ids, which floats would round.
bool is_color(const std::string& channel)
{
    constexpr std::string_view colors[] = {"R", "G", "B", "A", "Y", "RY", "BY"};
    return std::find(std::begin(colors), std::end(colors), channel) != std::end(colors);
}

bool has_channels(const std::vector<std::string>& channels, std::initializer_list<const char*> wanted)
{
    return std::all_of(wanted.begin(), wanted.end(), [&](const char* name) {
        return std::find(channels.begin(), channels.end(), name) != channels.end();
    });
}

Image::Layer& layer_named(Image& image, const std::string& name)
{
    for (Image::Layer& layer : image.layers)
        if (layer.name == name) return layer;
    return image.layers.emplace_back(Image::Layer{name, {}, {}});
}

/// Rank of a layer as the main image, from its name and channels; lower ranks are better.
int main_image_rank(const std::string& layer, const std::vector<std::string>& channels)
{
    constexpr std::string_view usual_names[] = {"beauty", "color", "colour", "combined",
                                                "image",  "main",  "rgb",    "rgba"};
    std::string last = layer.substr(layer.rfind('.') + 1);
    for (char& c : last) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
    const bool is_usual = std::find(std::begin(usual_names), std::end(usual_names), last) != std::end(usual_names);
    const int by_name = layer.empty() ? 0 : is_usual ? 1 : 2;
    const int by_channels = has_channels(channels, {"R", "G", "B"}) ? 0 : has_channels(channels, {"Y"}) ? 3 : 6;
    return by_channels + by_name;
}

/// The rank of a part by its best layer; lower ranks are better. Nothing if OpenEXR does not read the part as an image.
std::optional<int> part_rank(const Imf::Header& header)
{
    if (header.hasType() && header.type() != Imf::SCANLINEIMAGE && header.type() != Imf::TILEDIMAGE) return {};
    std::map<std::string, std::vector<std::string>> layers;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        const auto [layer, channel] = layer_and_channel(c.name());
        layers[layer].push_back(channel);
    }
    std::optional<int> best;
    for (const auto& [layer, channels] : layers) {
        const int rank = main_image_rank(layer, channels);
        best = best ? std::min(*best, rank) : rank;
    }
    return best;
}

/// Index of the part of a multi-part file that contains the main image.
std::size_t main_image_part(const EncodedImage& file, const std::vector<Imf::Header>& headers)
{
    std::optional<std::size_t> found;
    std::optional<int> least;
    for (std::size_t i = 0; i < headers.size(); ++i) {
        const std::optional<int> rank = part_rank(headers[i]);
        if (!rank || (least && *rank >= *least)) continue;
        least = rank;
        found = i;
    }
    if (!found) throw Error(file.name, "", "it contains no image that can be read: its parts are deep or empty");
    return *found;
}

std::array<std::uint64_t, 2> size_of(const Imath::Box2i& window)
{
    const auto side = [](int from, int to) {
        return std::uint64_t(std::max<std::int64_t>(std::int64_t(to) - from + 1, 0));
    };
    return {side(window.min.x, window.max.x), side(window.min.y, window.max.y)};
}

/// Checks sizes before OpenEXR allocates tables from them. The returned image has the size of the display window.
void check_sizes(const EncodedImage& file, const std::vector<Imf::Header>& headers, const Imf::Header& picture)
{
    std::uint64_t channels = 0;
    for (auto c = picture.channels().begin(); c != picture.channels().end(); ++c) ++channels;
    const auto display = size_of(picture.displayWindow());
    check_size(file, display[0], display[1], channels * sizeof(float) + 1);
    for (const Imf::Header& header : headers) {
        const auto data = size_of(header.dataWindow());
        check_size(file, data[0], data[1], channels * sizeof(float) + 1);
        // The offset table has 8 bytes for each chunk of the file.
        if (header.hasChunkCount() && (header.chunkCount() < 0 || std::size_t(header.chunkCount()) > file.size / 8))
            throw Error(file.name, "", "the file is truncated or damaged");
    }
}

/// Returns the primaries that the file states. Throws Error if they allow no conversion.
std::optional<Chromaticities> read_chromaticities(const EncodedImage& file, const Imf::Header& header)
{
    if (!Imf::hasChromaticities(header)) return {};
    const Imf::Chromaticities& c = Imf::chromaticities(header);
    const auto point = [](const Imath::V2f& v) { return Vec2f{v.x, v.y}; };
    const Chromaticities chromaticities{point(c.red), point(c.green), point(c.blue), point(c.white)};
    try {
        conversion(chromaticities, rec709_chromaticities);
    } catch (const Error& error) {
        throw Error(file.name, error.place(), error.message());
    }
    return chromaticities;
}

/// Reads the channels of the data window, grouped by layers. Chroma at half resolution is left to add_chroma().
template <class Input>
class PartReader {
public:
    PartReader(const EncodedImage& file, Input& input)
        : file_(file), input_(input), window_(input.header().dataWindow())
    {
        if (!input.isComplete()) throw Error(file.name, "", "the file is truncated: rows of the image are missing");
    }

    Image read()
    {
        const auto size = size_of(window_);
        image_.width = int(size[0]), image_.height = int(size[1]);
        const Imf::ChannelList& channels = input_.header().channels();
        image_.layers.push_back({"", {}, {}});
        for (auto c = channels.begin(); c != channels.end(); ++c) add(c.name(), c.channel());
        std::erase_if(image_.layers, [](const Image::Layer& layer) { return layer.channels.empty(); });
        if (image_.layers.empty())
            throw Error(file_.name, "", "it contains no image: all its channels are integers, such as ids");
        for (Image::Layer& layer : image_.layers) insert(layer);
        for (Image::UintChannel& channel : image_.uint_channels)
            insert(channel.name, Imf::UINT, channel.values.data(), sizeof(std::uint32_t));
        input_.setFrameBuffer(buffer_);
        input_.readPixels(window_.min.y, window_.max.y);
        return std::move(image_);
    }

private:
    void add(const std::string& name, const Imf::Channel& channel)
    {
        const auto [layer, short_name] = layer_and_channel(name);
        if (channel.xSampling != 1 || channel.ySampling != 1) {
            if (is_half_chroma(short_name, channel)) return;
            throw Error(file_.name, name,
                        "channels at reduced resolution are not supported, except chroma at half resolution");
        }
        if (channel.type == Imf::UINT && !is_color(short_name)) {
            image_.uint_channels.push_back({name, std::vector<std::uint32_t>(pixels())});
            return;
        }
        layer_named(image_, layer).channels.push_back(short_name);
    }
    void insert(Image::Layer& layer)
    {
        std::sort(layer.channels.begin(), layer.channels.end(), [](const auto& a, const auto& b) {
            return std::pair(channel_rank(a), a) < std::pair(channel_rank(b), b);
        });
        layer.pixels.resize(pixels() * layer.channels.size());
        for (std::size_t c = 0; c < layer.channels.size(); ++c)
            insert(full_name(layer.name, layer.channels[c]), Imf::FLOAT, layer.pixels.data() + c,
                   layer.channels.size() * sizeof(float));
    }
    void insert(const std::string& name, Imf::PixelType type, void* values, std::size_t stride)
    {
        const auto width = std::ptrdiff_t(image_.width);
        const std::ptrdiff_t offset = std::ptrdiff_t(stride) * (window_.min.x + width * window_.min.y);
        buffer_.insert(name,
                       Imf::Slice(type, static_cast<char*>(values) - offset, stride, stride * std::size_t(width)));
    }
    std::size_t pixels() const { return std::size_t(image_.width) * std::size_t(image_.height); }

    const EncodedImage& file_;
    Input& input_;
    const Imath::Box2i window_;
    Image image_;
    Imf::FrameBuffer buffer_;
};

Image read_part(const EncodedImage& file, bool has_parts, std::size_t part, int threads)
{
    ExrMemoryInput stream(file);
    if (!has_parts) {
        Imf::InputFile input(stream, threads);
        return PartReader(file, input).read();
    }
    Imf::MultiPartInputFile parts(stream, threads);
    Imf::InputPart input(parts, int(part));
    return PartReader(file, input).read();
}

/// Crops or pads values from the data window to the display window; padding is 0.
template <class T>
std::vector<T> placed(const std::vector<T>& values, std::size_t channels, const Imath::Box2i& data,
                      const Imath::Box2i& display)
{
    const auto from = size_of(data), to = size_of(display);
    std::vector<T> result(channels * to[0] * to[1]);
    const std::int64_t left = std::max(data.min.x, display.min.x), right = std::min(data.max.x, display.max.x);
    if (left > right) return result;
    for (std::int64_t y = std::max(data.min.y, display.min.y); y <= std::min(data.max.y, display.max.y); ++y) {
        const std::size_t source = std::size_t(y - data.min.y) * from[0] + std::size_t(left - data.min.x);
        const std::size_t target = std::size_t(y - display.min.y) * to[0] + std::size_t(left - display.min.x);
        std::copy_n(values.begin() + std::ptrdiff_t(channels * source), channels * std::size_t(right - left + 1),
                    result.begin() + std::ptrdiff_t(channels * target));
    }
    return result;
}

/// Crops overscan beyond the display window and pads areas outside the data window with transparent black.
void place_in_display(Image& image, const Imath::Box2i& data, const Imath::Box2i& display)
{
    if (data == display) return;
    for (Image::Layer& layer : image.layers) layer.pixels = placed(layer.pixels, layer.channels.size(), data, display);
    for (Image::UintChannel& channel : image.uint_channels) channel.values = placed(channel.values, 1, data, display);
    const auto size = size_of(display);
    image.width = int(size[0]), image.height = int(size[1]);
}

/// Moves the main image to the front; if all layers have names, the likeliest one by main_image_rank() is taken.
void move_main_image_first(std::vector<Image::Layer>& layers)
{
    const auto rank = [](const Image::Layer& layer) { return main_image_rank(layer.name, layer.channels); };
    const auto best =
        std::min_element(layers.begin(), layers.end(), [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
    std::rotate(layers.begin(), best, best + 1);
}

}  // namespace

Image read_exr(const EncodedImage& file)
{
    if (!exr_headers_end(file.bytes, file.size)) throw Error(file.name, "", "the file is truncated or damaged");
    const std::vector<Imf::Header> headers = read_exr_headers(file);
    const std::size_t part = main_image_part(file, headers);
    const Imf::Header& header = headers[part];
    check_sizes(file, headers, header);
    const auto size = size_of(header.dataWindow());
    // For small images, waking threads takes longer than reading.
    const int threads = size[0] * size[1] < 1 << 16 ? 0 : exr_threads();
    Image image = read_part(file, headers.size() > 1, part, threads);
    add_chroma(image, file, header, part > 0, threads);
    place_in_display(image, header.dataWindow(), header.displayWindow());
    move_main_image_first(image.layers);

    for (auto a = header.begin(); a != header.end(); ++a)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
            image.attributes[a.name()] = text->value();
    image.is_linear = true;
    image.chromaticities = read_chromaticities(file, header);
    return image;
}

}  // namespace fathom
