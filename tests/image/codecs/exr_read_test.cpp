// SPDX-License-Identifier: Apache-2.0
// Tests of EXR files as other programs write them, made with OpenEXR's writers.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "fathom/error.h"
#include "image/picture.h"
#include "image/pictures.h"

namespace fathom {
namespace {

using test::TemporaryFolder;
using Value = std::function<double(int x, int y)>;  ///< value at the pixel coordinates of the file

struct Channel {
    Imf::PixelType type;
    Value value;
    int sampling = 1;
};
using Channels = std::map<std::string, Channel>;

/// Storage for the channels of a data window.
class Buffer {
public:
    Buffer(Imf::Header& header, const Channels& channels)
    {
        const Imath::Box2i window = header.dataWindow();
        for (const auto& [name, channel] : channels) {
            header.channels().insert(name, Imf::Channel(channel.type, channel.sampling, channel.sampling));
            const int s = channel.sampling, columns = (window.max.x - window.min.x) / s + 1;
            const int rows = (window.max.y - window.min.y) / s + 1;
            std::vector<float>& floats = floats_.emplace_back(std::size_t(columns) * std::size_t(rows));
            std::vector<unsigned>& integers = integers_.emplace_back(floats.size());
            for (int y = 0; y < rows; ++y)
                for (int x = 0; x < columns; ++x) {
                    const double v = channel.value(window.min.x + s * x, window.min.y + s * y);
                    floats[std::size_t(y * columns + x)] = float(v);
                    integers[std::size_t(y * columns + x)] = unsigned(std::max(v, 0.0));
                }
            const bool is_uint = channel.type == Imf::UINT;
            char* const first =
                is_uint ? reinterpret_cast<char*>(integers.data()) : reinterpret_cast<char*>(floats.data());
            const std::ptrdiff_t offset = 4 * (window.min.x / s + std::ptrdiff_t(columns) * (window.min.y / s));
            buffer.insert(
                name, Imf::Slice(is_uint ? Imf::UINT : Imf::FLOAT, first - offset, 4, 4 * std::size_t(columns), s, s));
        }
    }
    Imf::FrameBuffer buffer;

private:
    std::vector<std::vector<float>> floats_;
    std::vector<std::vector<unsigned>> integers_;
};

Imath::Box2i box(int left, int top, int right, int bottom)
{
    return {{left, top}, {right, bottom}};
}

class ExrRead : public ::testing::Test {
protected:
    std::string file() const { return (folder_.path() / "a.exr").string(); }

    /// Image read back from a file with these windows; half channels are converted from floats.
    Image written(Imf::Header header, Channels channels)
    {
        for (auto& [name, channel] : channels)
            if (channel.type == Imf::HALF) channel.type = Imf::FLOAT;
        const Buffer buffer(header, channels);
        {
            Imf::OutputFile output(file().c_str(), header);
            output.setFrameBuffer(buffer.buffer);
            output.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
        }
        return read_image(file());
    }

    TemporaryFolder folder_;
};

float at(const Image& image, int x, int y, const std::string& channel)
{
    const Image::Layer& layer = image.layers.at(0);
    for (std::size_t c = 0; c < layer.channels.size(); ++c)
        if (layer.channels[c] == channel)
            return layer.pixels.at(
                (std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * layer.channels.size() + c);
    ADD_FAILURE() << channel;
    return -1;
}

const Value x_of = [](int x, int) { return x; }, y_of = [](int, int y) { return y; }, one = [](int, int) { return 1; };

/// Pixels are placed by the display window: overscan is cropped and missing pixels are transparent black.
TEST_F(ExrRead, DataWindowsLieWithinDisplayWindows)
{
    const Imath::Box2i display[] = {box(0, 0, 7, 4), box(-3, 10, 4, 14), box(100, -20, 107, -16)};
    const Imath::Box2i data[] = {{{0, 0}, {7, 4}},  {{2, 1}, {4, 3}}, {{-5, -2}, {12, 9}}, {{5, -2}, {12, 2}},
                                 {{-4, 3}, {1, 8}}, {{7, 4}, {7, 4}}, {{8, 0}, {9, 4}},    {{0, -3}, {7, -1}}};
    for (const Imath::Box2i& shown : display)
        for (const Imath::Box2i& relative : data) {
            Imf::Header header(shown, {relative.min + shown.min, relative.max + shown.min});
            const Image image = written(header, {{"R", {Imf::FLOAT, x_of}},
                                                 {"G", {Imf::FLOAT, y_of}},
                                                 {"B", {Imf::FLOAT, one}},
                                                 {"A", {Imf::FLOAT, one}},
                                                 {"id", {Imf::UINT, [](int, int) { return 7; }}}});
            ASSERT_EQ(image.width, 8);
            ASSERT_EQ(image.height, 5);
            for (int y = 0; y < 5; ++y)
                for (int x = 0; x < 8; ++x) {
                    const bool is_there = relative.intersects(Imath::V2i(x, y));
                    EXPECT_EQ(at(image, x, y, "R"), is_there ? float(x + shown.min.x) : 0.f);
                    EXPECT_EQ(at(image, x, y, "G"), is_there ? float(y + shown.min.y) : 0.f);
                    EXPECT_EQ(at(image, x, y, "A"), is_there ? 1.f : 0.f);
                    EXPECT_EQ(image.uint_channels.at(0).values.at(std::size_t(8 * y + x)), is_there ? 7u : 0u);
                }
            const auto size = image_size(file());
            ASSERT_TRUE(size.has_value());
            EXPECT_EQ(*size, (std::array<std::uint64_t, 2>{8, 5}));
        }
}

/// Color channels are converted to floats from any type; other integer channels are ids.
TEST_F(ExrRead, IntegersAsColors)
{
    const Imf::Header header(4, 3);
    const Image all = written(header, {{"R", {Imf::UINT, x_of}}, {"G", {Imf::UINT, y_of}}, {"B", {Imf::UINT, one}}});
    EXPECT_EQ(all.layers.at(0).channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(at(all, 3, 2, "R"), 3);
    EXPECT_EQ(at(all, 3, 2, "G"), 2);
    const Image mixed = written(header, {{"R", {Imf::FLOAT, [](int x, int) { return x + 0.5; }}},
                                         {"G", {Imf::UINT, y_of}},
                                         {"B", {Imf::HALF, one}},
                                         {"object", {Imf::UINT, x_of}}});
    EXPECT_EQ(at(mixed, 1, 2, "R"), 1.5f);
    EXPECT_EQ(at(mixed, 1, 2, "G"), 2);
    EXPECT_EQ(at(mixed, 1, 2, "B"), 1);
    EXPECT_EQ(mixed.uint_channels.at(0).name, "object");
    const Image gray = written(header, {{"Y", {Imf::UINT, x_of}}});
    EXPECT_EQ(at(gray, 2, 0, "Y"), 2);
}

/// The image is the layer without a name, one with a common name, or the first one with color channels.
TEST_F(ExrRead, LayersAndViews)
{
    const Imf::Header header(4, 3);
    const auto colors = [](Channels& channels, const std::string& layer, double value) {
        for (const char* c : {".R", ".G", ".B"}) channels[layer + c] = {Imf::FLOAT, [=](int, int) { return value; }};
    };
    Channels channels{{"Z", {Imf::FLOAT, one}}};
    colors(channels, "albedo", 2);
    colors(channels, "left", 3);
    EXPECT_EQ(at(written(header, channels), 0, 0, "R"), 2);
    colors(channels, "ViewLayer.Combined", 4);
    EXPECT_EQ(at(written(header, channels), 0, 0, "G"), 4);
    for (const char* c : {"R", "G", "B"}) channels[c] = {Imf::FLOAT, [](int, int) { return 5; }};
    const Image all = written(header, channels);
    EXPECT_EQ(at(all, 0, 0, "B"), 5);
    EXPECT_EQ(all.layers.size(), 4u);
}

TEST_F(ExrRead, Parts)
{
    const char* const names[] = {"depth", "beauty", "albedo"};
    std::vector<Imf::Header> headers(3, Imf::Header(4, 3));
    std::vector<Buffer> buffers;
    for (std::size_t i = 0; i < 3; ++i) {
        headers[i].setName(names[i]);
        headers[i].setType(Imf::SCANLINEIMAGE);
        Channels channels{{"Z", {Imf::FLOAT, one}}};
        if (i > 0)
            for (const char* c : {"R", "G", "B"})
                channels[c] = {Imf::FLOAT, [=](int x, int) { return double(i) + 10 * x; }};
        buffers.emplace_back(headers[i], channels);
    }
    {
        Imf::MultiPartOutputFile output(file().c_str(), headers.data(), 3);
        for (int i = 0; i < 3; ++i) {
            Imf::OutputPart part(output, i);
            part.setFrameBuffer(buffers[std::size_t(i)].buffer);
            part.writePixels(3);
        }
    }
    const Image image = read_image(file());
    EXPECT_EQ(at(image, 2, 1, "R"), 21);
    EXPECT_EQ(image.attributes.at("name"), "beauty");
}

const Imf::Chromaticities wide{{0.7f, 0.3f}, {0.2f, 0.75f}, {0.14f, 0.05f}, {0.32f, 0.33f}};

/// Luminance weights are those of SMPTE RP 177, computed independently of OpenEXR (BT.709: 0.2126, 0.7152, 0.0722).
TEST_F(ExrRead, LuminanceWithFullChroma)
{
    const double r = 0.8, g = 0.3, b = 0.1, y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    const auto is = [](double v) { return Channel{Imf::FLOAT, [=](int, int) { return v; }}; };
    const Channels channels{{"Y", is(y)}, {"RY", is((r - y) / y)}, {"BY", is((b - y) / y)}, {"A", is(0.5)}};
    const Image image = written(Imf::Header(3, 2), channels);
    EXPECT_EQ(image.layers.at(0).channels, (std::vector<std::string>{"R", "G", "B", "A"}));
    EXPECT_NEAR(at(image, 2, 1, "R"), r, 1e-6);
    EXPECT_NEAR(at(image, 2, 1, "G"), g, 1e-4);
    EXPECT_NEAR(at(image, 2, 1, "B"), b, 1e-6);
    EXPECT_EQ(at(image, 2, 1, "A"), 0.5f);
}

/// Smooth images in OpenEXR's luminance-chroma files with nonstandard primaries are restored.
TEST_F(ExrRead, LuminanceWithChromaAtHalf)
{
    constexpr int width = 32, height = 24;
    const auto color = [](int x, int y) {
        return Imf::Rgba(float(0.2 + 0.01 * x), float(0.5 + 0.01 * y), float(0.8 - 0.01 * x), 0.25f);
    };
    std::vector<Imf::Rgba> pixels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) pixels.push_back(color(x, y));
    for (const bool has_primaries : {false, true})
        for (const bool has_alpha : {false, true}) {
            Imf::Header header(box(0, 0, width - 1, height - 1), box(-4, 2, width - 5, height + 1));
            if (has_primaries) Imf::addChromaticities(header, wide);
            {
                Imf::RgbaOutputFile output(file().c_str(), header, has_alpha ? Imf::WRITE_YCA : Imf::WRITE_YC);
                output.setFrameBuffer(pixels.data() + 4 - 2 * width, 1, width);
                output.writePixels(height);
            }
            const Image image = read_image(file());
            ASSERT_EQ(image.width, width);
            EXPECT_EQ(image.chromaticities.has_value(), has_primaries);
            for (int y = 4; y < height - 4; ++y)
                for (int x = 4; x < width - 8; ++x) {
                    const Imf::Rgba c = color(x + 4, y - 2);
                    EXPECT_NEAR(at(image, x, y, "R"), float(c.r), 4e-3);
                    EXPECT_NEAR(at(image, x, y, "G"), float(c.g), 4e-3);
                    EXPECT_NEAR(at(image, x, y, "B"), float(c.b), 4e-3);
                    if (has_alpha) EXPECT_EQ(at(image, x, y, "A"), 0.25f);
                }
            EXPECT_EQ(at(image, 0, 0, "G"), 0) << "above the data window";
        }
}

TEST_F(ExrRead, LuminanceAlone)
{
    const Image image = written(Imf::Header(4, 3), {{"Y", {Imf::HALF, x_of}}, {"A", {Imf::HALF, one}}});
    EXPECT_EQ(image.layers.at(0).channels, (std::vector<std::string>{"A", "Y"}));
    EXPECT_EQ(at(image, 3, 0, "Y"), 3);
}

TEST_F(ExrRead, OtherReducedChannelsAreRefused)
{
    try {
        written(Imf::Header(4, 4), {{"R", {Imf::FLOAT, one}}, {"G", {Imf::FLOAT, one}}, {"B", {Imf::FLOAT, one, 2}}});
        ADD_FAILURE() << "read";
    } catch (const Error& error) {
        EXPECT_EQ(error.place() + ": " + error.message(),
                  "B: channels at reduced resolution are not supported, except chroma at half resolution");
    }
}

}  // namespace
}  // namespace fathom
