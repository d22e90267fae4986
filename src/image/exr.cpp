#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>
#include <half.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "fathom/error.h"
#include "image/formats.h"
#include "image/output_file.h"
#include "image/primaries.h"
#include "scene/machine.h"

namespace fathom {

namespace {

class MemoryInput : public Imf::IStream {
public:
    explicit MemoryInput(const EncodedImage& file) : Imf::IStream(file.name.c_str()), file_(file) {}

    bool read(char destination[], int size) override
    {
        if (size < 0 || std::size_t(size) > file_.size - position_)
            throw Error(file_.name, "", "the file is cut short or damaged");
        std::memcpy(destination, file_.bytes + position_, std::size_t(size));
        position_ += std::size_t(size);
        return position_ < file_.size;
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = std::min<std::uint64_t>(position, file_.size); }

private:
    const EncodedImage& file_;
    std::size_t position_ = 0;
};

class FileOutput : public Imf::OStream {
public:
    explicit FileOutput(OutputFile& file) : Imf::OStream("picture"), file_(file) {}

    void write(const char bytes[], int size) override { file_.write(bytes, std::size_t(size)); }
    std::uint64_t tellp() override { return file_.tell(); }
    void seekp(std::uint64_t position) override { file_.seek(position); }

private:
    OutputFile& file_;
};

int compression_threads()
{
    // OpenEXR's pool is the process's; a program that has set it up keeps its choice. Once: pictures are read by
    // several threads, and the pool must not change under one of them.
    static const int threads = [] {
        if (Imf::globalThreadCount() == 0)
            Imf::setGlobalThreadCount(startable_threads(1 + std::min(usable_cores("/"), 4)) - 1);
        return Imf::globalThreadCount();
    }();
    return threads;
}

/// R G B A X Y Z before all others, which are sorted by name.
int channel_rank(const std::string& channel)
{
    static const std::string order = "RGBAXYZ";
    return channel.size() == 1 && order.find(channel) != std::string::npos ? int(order.find(channel))
                                                                           : int(order.size());
}

Image::Layer& layer_named(Image& image, const std::string& name)
{
    for (Image::Layer& layer : image.layers)
        if (layer.name == name) return layer;
    return image.layers.emplace_back(Image::Layer{name, {}, {}});
}

std::string full_name(const std::string& layer, const std::string& channel)
{
    return layer.empty() ? channel : layer + "." + channel;
}

/// Colours in half's range may be halves. Ids, distances and variances would suffer: half has 11 bits, and nothing
/// below 6e-8.
bool fits_half(const Image::Layer& layer)
{
    constexpr float largest_half = 65504;
    if (layer.name == "variance") return false;
    for (const std::string& channel : layer.channels)
        if (channel != "R" && channel != "G" && channel != "B" && channel != "A") return false;
    return std::none_of(layer.pixels.begin(), layer.pixels.end(),
                        [](float v) { return std::abs(v) > largest_half && !std::isinf(v); });
}

/// What OpenEXR reads of an attribute, whatever its length is said to be; 0: as much as is said.
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

/// Whether these bytes are a list of channels, which an empty name ends, and nothing else.
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

/// OpenEXR believes an attribute's length and asks for as much memory. Where it reads less than that, it goes on in the
/// middle.
void check_attributes(const EncodedImage& file)
{
    const auto fail = [&] { throw Error(file.name, "", "the file is cut short or damaged"); };
    const char* const characters = reinterpret_cast<const char*>(file.bytes);
    std::size_t at = 8;
    const auto skip_word = [&] {
        const auto* end = at < file.size ? std::memchr(file.bytes + at, 0, file.size - at) : nullptr;
        if (!end) fail();
        at = std::size_t(static_cast<const unsigned char*>(end) - file.bytes) + 1;
    };
    if (file.size < at) fail();
    const bool has_parts = file.bytes[5] & 0x10;
    do {
        while (at < file.size && file.bytes[at] != 0) {
            skip_word();  // name
            const std::size_t type_at = at;
            skip_word();
            const std::string_view type(characters + type_at, at - type_at - 1);
            std::uint32_t size = 0;
            if (file.size - at < 4) fail();
            for (int i = 3; i >= 0; --i) size = size << 8 | file.bytes[at + std::size_t(i)];
            at += 4;
            if (size > file.size - at) fail();
            if (fixed_size(type) > 0 && size != fixed_size(type)) fail();
            if (type == "chlist" && !is_channel_list({characters + at, size})) fail();
            at += size;
        }
        if (++at >= file.size) fail();
        // Files of several parts end their headers with an empty one.
    } while (has_parts && file.bytes[at] != 0);
}

/// What the file says of its colours; those that nothing can be computed from are damage.
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

/// The layers in other primaries. Variances stay: those of a mixture of channels don't follow from the channels'.
std::vector<Image::Layer> converted_layers(const Image& image, const Chromaticities& primaries)
{
    const ColorMatrix matrix = conversion(rec709_chromaticities, primaries);
    std::vector<Image::Layer> layers = image.layers;
    for (Image::Layer& layer : layers)
        if (layer.name != "variance") convert(layer, matrix);
    return layers;
}

void add_chromaticities(Imf::Header& header, const Chromaticities& c)
{
    const auto point = [](Vec2f v) { return Imath::V2f(v.x, v.y); };
    Imf::addChromaticities(header, Imf::Chromaticities(point(c.red), point(c.green), point(c.blue), point(c.white)));
}

}  // namespace

Image read_exr(const EncodedImage& file)
{
    check_attributes(file);
    bool is_small = true;
    {
        // The size is looked at before OpenEXR makes tables of it.
        MemoryInput stream(file);
        char start[8];  // the magic number, then the version and flags, lowest byte first
        stream.read(start, sizeof start);
        int version = 0;
        for (int i = 7; i >= 4; --i) version = version << 8 | static_cast<unsigned char>(start[i]);
        Imf::Header header;
        header.readFrom(stream, version);
        const auto& window = header.dataWindow();
        std::uint64_t channels = 0;
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c) ++channels;
        check_size(file, std::uint64_t(std::max<std::int64_t>(std::int64_t(window.max.x) - window.min.x + 1, 0)),
                   std::uint64_t(std::max<std::int64_t>(std::int64_t(window.max.y) - window.min.y + 1, 0)),
                   channels * sizeof(float) + 1);
        // Threads take longer to wake up than such a picture takes to read.
        is_small = (std::int64_t(window.max.x) - window.min.x) * (std::int64_t(window.max.y) - window.min.y) < 1 << 16;
    }
    MemoryInput stream(file);
    Imf::InputFile input(stream, is_small ? 0 : compression_threads());
    if (!input.isComplete()) throw Error(file.name, "", "the file is cut short: rows of the picture are missing");

    const Imf::Header& header = input.header();
    const auto& window = header.dataWindow();
    Image image;
    image.width = window.max.x - window.min.x + 1;
    image.height = window.max.y - window.min.y + 1;
    const std::size_t width = std::size_t(image.width), pixels = width * std::size_t(image.height);

    image.layers.push_back({"", {}, {}});
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        const std::string name = c.name();
        if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
            throw Error(file.name, name, "channels at reduced resolution (luminance-chroma) can't be read");
        if (c.channel().type == Imf::UINT) {
            image.uint_channels.push_back({name, std::vector<std::uint32_t>(pixels)});
            continue;
        }
        const std::size_t dot = name.rfind('.');
        Image::Layer& layer = layer_named(image, dot == std::string::npos ? "" : name.substr(0, dot));
        layer.channels.push_back(dot == std::string::npos ? name : name.substr(dot + 1));
    }
    if (image.layers[0].channels.empty()) image.layers.erase(image.layers.begin());
    if (image.layers.empty())
        throw Error(file.name, "", "there is no picture in it: all its channels are integers, as ids have them");

    Imf::FrameBuffer buffer;
    const auto insert = [&](const std::string& name, Imf::PixelType type, void* values, std::size_t stride) {
        const std::ptrdiff_t offset = std::ptrdiff_t(stride) * (window.min.x + std::ptrdiff_t(width) * window.min.y);
        buffer.insert(name, Imf::Slice(type, static_cast<char*>(values) - offset, stride, stride * width));
    };
    for (Image::Layer& layer : image.layers) {
        std::sort(layer.channels.begin(), layer.channels.end(), [](const auto& a, const auto& b) {
            return std::pair(channel_rank(a), a) < std::pair(channel_rank(b), b);
        });
        layer.pixels.resize(pixels * layer.channels.size());
        for (std::size_t c = 0; c < layer.channels.size(); ++c)
            insert(full_name(layer.name, layer.channels[c]), Imf::FLOAT, layer.pixels.data() + c,
                   layer.channels.size() * sizeof(float));
    }
    for (Image::UintChannel& channel : image.uint_channels)
        insert(channel.name, Imf::UINT, channel.values.data(), sizeof(std::uint32_t));
    input.setFrameBuffer(buffer);
    input.readPixels(window.min.y, window.max.y);

    for (auto a = header.begin(); a != header.end(); ++a)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
            image.attributes[a.name()] = text->value();
    image.is_linear = true;
    image.chromaticities = read_chromaticities(file, header);
    return image;
}

// A picture of noise hardly compresses. 800x600 RGB float (5.8 MB), 2 cores, milliseconds and MB written:
//   none 3, 5.8 | RLE 16, 5.6 | ZIPS level 1 60, 5.1 | ZIP level 1 69, 5.0 | ZIP level 4 86, 4.9 | PIZ 141, 5.8
// So a plain picture in float is not compressed; more layers (flat albedo, ids) and sums (empty high words) are, and
// halves.
void write_exr(OutputFile& file, const Image& image, const WriteOptions& options)
{
    Imf::Header header(image.width, image.height);
    const bool plain = image.layers.size() == 1 && image.uint_channels.empty() && !options.exr_half;
    header.compression() = plain ? Imf::NO_COMPRESSION : Imf::ZIP_COMPRESSION;
    header.zipCompressionLevel() = 1;
    for (const auto& [name, value] : image.attributes) header.insert(name, Imf::StringAttribute(value));
    const bool is_converted = options.exr_primaries != Primaries::rec709;  // which is what no attribute stands for
    std::vector<Image::Layer> converted;
    if (is_converted) {
        const Chromaticities primaries = chromaticities_of(options.exr_primaries);
        converted = converted_layers(image, primaries);
        add_chromaticities(header, primaries);
    }

    const std::size_t width = std::size_t(image.width);
    Imf::FrameBuffer buffer;
    const auto insert = [&](const std::string& name, Imf::PixelType type, const void* values, std::size_t stride) {
        header.channels().insert(name, Imf::Channel(type));
        // OpenEXR has one type for buffers that it reads into and that it only looks at.
        char* base = const_cast<char*>(static_cast<const char*>(values));
        buffer.insert(name, Imf::Slice(type, base, stride, stride * width));
    };
    std::vector<std::vector<half>> halves;
    for (const Image::Layer& layer : is_converted ? converted : image.layers) {
        const std::size_t channels = layer.channels.size();
        const bool as_half = options.exr_half && fits_half(layer);
        if (as_half) halves.emplace_back(layer.pixels.begin(), layer.pixels.end());
        for (std::size_t c = 0; c < channels; ++c) {
            const std::string name = full_name(layer.name, layer.channels[c]);
            if (as_half)
                insert(name, Imf::HALF, halves.back().data() + c, channels * sizeof(half));
            else
                insert(name, Imf::FLOAT, layer.pixels.data() + c, channels * sizeof(float));
        }
    }
    for (const Image::UintChannel& channel : image.uint_channels)
        insert(channel.name, Imf::UINT, channel.values.data(), sizeof(std::uint32_t));

    FileOutput stream(file);
    Imf::OutputFile output(stream, header, plain ? 0 : compression_threads());
    output.setFrameBuffer(buffer);
    output.writePixels(image.height);
}

}  // namespace fathom
