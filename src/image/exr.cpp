#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <algorithm>

#include "fathom/error.h"
#include "image/exr_parts.h"
#include "image/output_file.h"
#include "image/primaries.h"
#include "scene/machine.h"

namespace fathom {

namespace {

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

}  // namespace

Image read_exr(const EncodedImage& file)
{
    if (!exr_headers_end(file.bytes, file.size)) throw Error(file.name, "", "the file is cut short or damaged");
    bool is_small = true;
    {
        // The size is looked at before OpenEXR makes tables of it.
        const Imf::Header header = read_exr_header(file);
        const auto& window = header.dataWindow();
        std::uint64_t channels = 0;
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c) ++channels;
        check_size(file, std::uint64_t(std::max<std::int64_t>(std::int64_t(window.max.x) - window.min.x + 1, 0)),
                   std::uint64_t(std::max<std::int64_t>(std::int64_t(window.max.y) - window.min.y + 1, 0)),
                   channels * sizeof(float) + 1);
        // Threads take longer to wake up than such a picture takes to read.
        is_small = (std::int64_t(window.max.x) - window.min.x) * (std::int64_t(window.max.y) - window.min.y) < 1 << 16;
    }
    ExrMemoryInput stream(file);
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
    ExrChannels parts(image, options);
    const bool plain = image.layers.size() == 1 && image.uint_channels.empty() && !options.exr_half;
    parts.header.compression() = plain ? Imf::NO_COMPRESSION : Imf::ZIP_COMPRESSION;
    parts.header.zipCompressionLevel() = 1;
    Imf::FrameBuffer buffer;
    for (const ExrChannels::Channel& channel : parts.channels) {
        // OpenEXR has one type for buffers that it reads into and that it only looks at.
        char* const first = const_cast<char*>(channel.first);
        buffer.insert(channel.name,
                      Imf::Slice(channel.type, first, channel.stride, channel.stride * std::size_t(image.width)));
    }
    FileOutput stream(file);
    Imf::OutputFile output(stream, parts.header, plain ? 0 : compression_threads());
    output.setFrameBuffer(buffer);
    output.writePixels(image.height);
}

}  // namespace fathom
