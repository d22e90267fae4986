// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <webp/encode.h>
#include <bit>
#include <cstring>
#include <limits>

#include "fathom/error.h"
#include "pictures.h"

namespace fathom {
namespace {

using test::make_test_image;
using test::make_test_layer;
using test::TemporaryFolder;

Image written_and_read(const Image& image, const std::string& file, const WriteOptions& options = {})
{
    const TemporaryFolder folder;
    write_image(folder.path() / file, image, options);
    EXPECT_EQ(folder.files(), 1u);
    return read_image(folder.path() / file);
}

TEST(Exr, KeepsFloatsAttributesLayersAndIntegersBitForBit)
{
    Image image = make_test_image(37, 23, {"R", "G", "B", "A"}, 1e6f);
    image.layers[0].pixels[0] = std::numeric_limits<float>::infinity();
    image.layers[0].pixels[1] = std::numeric_limits<float>::denorm_min();
    image.layers.push_back(make_test_layer("albedo", {"R", "G", "B"}, 37, 23));
    image.layers.push_back(make_test_layer("depth", {"Z"}, 37, 23, 1e9f));
    image.layers.push_back(make_test_layer("normal", {"X", "Y", "Z"}, 37, 23));
    image.uint_channels.push_back({"sums.000", std::vector<std::uint32_t>(37 * 23, 0xffffffffu)});
    image.uint_channels.push_back({"sums.001", std::vector<std::uint32_t>(37 * 23, 16777217u)});
    image.attributes = {{"fathom.seed", "7"}, {"fathom.scene", "a \"scene\", of ünicode"}, {"empty", ""}};
    const Image read = written_and_read(image, "a.exr");
    ASSERT_EQ(read.width, 37);
    ASSERT_EQ(read.height, 23);
    ASSERT_EQ(read.layers.size(), image.layers.size());
    for (const Image::Layer& layer : image.layers) {
        const Image::Layer* other = read.find(layer.name);
        ASSERT_TRUE(other) << layer.name;
        EXPECT_EQ(other->channels, layer.channels);
        EXPECT_EQ(0, std::memcmp(other->pixels.data(), layer.pixels.data(), layer.pixels.size() * 4)) << layer.name;
    }
    ASSERT_EQ(read.uint_channels.size(), 2u);
    for (int i = 0; i < 2; ++i) {
        EXPECT_EQ(read.uint_channels[i].name, image.uint_channels[i].name);
        EXPECT_EQ(read.uint_channels[i].values, image.uint_channels[i].values);
    }
    for (const auto& [name, value] : image.attributes) EXPECT_EQ(read.attributes.at(name), value);
}

TEST(Exr, HalvesAreForColorsInTheirRange)
{
    WriteOptions options;
    options.exr_half = true;
    Image image = make_test_image(16, 9);
    image.layers[0].pixels[0] = 65504;
    image.layers[0].pixels[1] = 1.0004f;
    image.layers.push_back(make_test_layer("albedo", {"R", "G", "B"}, 16, 9));
    image.layers.back().pixels[5] = 65505;
    image.layers.push_back({"instance", {"Y"}, std::vector<float>(16 * 9, 2049)});
    image.layers.push_back({"variance", {"R", "G", "B"}, std::vector<float>(16 * 9 * 3, 1e-9f)});
    const Image read = written_and_read(image, "a.exr", options);
    EXPECT_EQ(read.find("")->pixels[0], 65504);
    EXPECT_EQ(read.find("")->pixels[1], 1.0f);
    for (std::size_t i = 0; i < image.layers[0].pixels.size(); ++i)
        EXPECT_NEAR(read.find("")->pixels[i], image.layers[0].pixels[i], image.layers[0].pixels[i] / 2048 + 6e-8);
    EXPECT_EQ(read.find("albedo")->pixels, image.layers[1].pixels);
    EXPECT_EQ(read.find("instance")->pixels, image.layers[2].pixels);
    EXPECT_EQ(read.find("variance")->pixels, image.layers[3].pixels);
}

TEST(Png, HasTheNearestCodeOfTheFormulaAtEachDepth)
{
    for (int bits : {8, 16}) {
        WriteOptions options;
        options.png_bits = bits;
        const double codes = bits == 8 ? 255 : 65535;
        const Image image = make_test_image(61, 40, {"R", "G", "B"}, 1.2f);
        const Image read = written_and_read(image, "a.png", options);
        ASSERT_EQ(read.layers[0].channels, image.layers[0].channels);
        for (std::size_t i = 0; i < image.layers[0].pixels.size(); ++i)
            ASSERT_NEAR(read.layers[0].pixels[i] * codes, test::srgb(image.layers[0].pixels[i]) * codes, 0.51) << bits;
    }
}

TEST(Png, AlphaIsStraight)
{
    for (int bits : {8, 16}) {
        WriteOptions options;
        options.png_bits = bits;
        Image image = make_test_image(2, 1, {"R", "G", "B", "A"});
        image.layers[0].pixels = {0.25f, 0.125f, 0, 0.5f, 0, 0, 0, 0};
        const Image read = written_and_read(image, "a.png", options);
        ASSERT_EQ(read.layers[0].channels, image.layers[0].channels);
        const std::vector<double> expected = {test::srgb(0.5), test::srgb(0.25), 0, 0.5, 0, 0, 0, 0};
        for (int i = 0; i < 8; ++i)
            EXPECT_NEAR(read.layers[0].pixels[i], expected[i], 0.51 / (bits == 8 ? 255 : 65535));
    }
}

TEST(Png, OneChannelIsGray)
{
    Image image = make_test_image(3, 2, {"Z"});
    const Image read = written_and_read(image, "a.png");
    for (int i = 0; i < 6; ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(read.layers[0].pixels[3 * i + c], test::srgb(image.layers[0].pixels[i]), 0.51 / 255);
}

TEST(Jpeg, IsCloseAndHasNoAlpha)
{
    Image image = make_test_image(40, 30, {"R", "G", "B", "A"});
    for (int i = 0; i < 40 * 30; ++i) {
        const float values[] = {float(i % 40) / 40, float(i / 40) / 30, 0.2f, 0.5f};
        std::copy(values, values + 4, image.layers[0].pixels.begin() + 4 * i);
    }
    const Image read = written_and_read(image, "a.jpeg");
    ASSERT_EQ(read.layers[0].channels, (std::vector<std::string>{"R", "G", "B"}));
    for (int i = 0; i < 40 * 30; ++i)
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(read.layers[0].pixels[3 * i + c], test::srgb(image.layers[0].pixels[4 * i + c]), 0.04);
}

TEST(Hdr, IsNearestAtEveryWidth)
{
    for (int width : {1, 7, 8, 9, 200, 32767, 32768}) {
        Image image = make_test_image(width, 3, {"R", "G", "B"}, 1000);
        // Make runs of equal pixels in the first row.
        for (int i = 0; i < 3 * width; ++i) image.layers[0].pixels[i] = float(i / 300);
        const Image read = written_and_read(image, "a.hdr");
        ASSERT_EQ(read.width, width);
        ASSERT_EQ(read.layers[0].channels, image.layers[0].channels);
        for (int i = 0; i < 3 * width; ++i) {
            const float* in = &image.layers[0].pixels[3 * i];
            const float top = std::max({in[0], in[1], in[2]});
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(read.layers[0].pixels[3 * i + c], in[c], top / 255) << width;
        }
    }
}

TEST(Hdr, ExtremesStayInRange)
{
    Image image = make_test_image(4, 1);
    const float infinity = std::numeric_limits<float>::infinity();
    image.layers[0].pixels = {infinity, 1, 0, NAN, -1, 0.999f, 1e-38f, 0, 0, 255.9f, 0.5f, 0};
    const Image read = written_and_read(image, "a.hdr");
    EXPECT_GT(read.layers[0].pixels[0], 1e38f);
    EXPECT_EQ(read.layers[0].pixels[3], 0);
    EXPECT_EQ(read.layers[0].pixels[4], 0);
    EXPECT_NEAR(read.layers[0].pixels[5], 0.999f, 0.004f);
    EXPECT_EQ(read.layers[0].pixels[6], 0);
    EXPECT_NEAR(read.layers[0].pixels[9], 255.9f, 1);
}

TEST(Webp, IsWrittenLikePngUnlessItMayLose)
{
    Image image = make_test_image(61, 40, {"R", "G", "B", "A"});
    const Image png = written_and_read(image, "a.png"), webp = written_and_read(image, "a.webp");
    ASSERT_EQ(webp.layers[0].channels, png.layers[0].channels);
    EXPECT_EQ(webp.layers[0].pixels, png.layers[0].pixels);
    // Lossy compression without alpha keeps a smooth image close to the original.
    image = make_test_image(64, 48, {"R", "G", "B"});
    for (int i = 0; i < 64 * 48; ++i)
        for (int c = 0; c < 3; ++c)
            image.layers[0].pixels[std::size_t(3 * i + c)] = float(i % 64) / 128 + float(i / 64) / 96;
    WriteOptions options;
    options.webp_quality = 90;
    const Image read = written_and_read(image, "a.webp", options);
    ASSERT_EQ(read.layers[0].channels, image.layers[0].channels);
    double largest = 0;
    for (std::size_t i = 0; i < read.layers[0].pixels.size(); ++i)
        largest = std::max(largest, std::abs(read.layers[0].pixels[i] - test::srgb(image.layers[0].pixels[i])));
    EXPECT_LT(largest, 0.05);
    EXPECT_GT(largest, 0.51 / 255);
}

TEST(Webp, LosslessKeepsCodes)
{
    const int width = 20, height = 10;
    std::vector<std::uint8_t> codes(width * height * 4);
    for (std::size_t i = 0; i < codes.size(); ++i) codes[i] = i % 4 == 3 ? 255 - i % 200 : std::uint8_t(i * 7);
    std::uint8_t* encoded = nullptr;
    const std::size_t size = WebPEncodeLosslessRGBA(codes.data(), width, height, width * 4, &encoded);
    const Image read = read_image("a.webp", encoded, size);
    ASSERT_EQ(read.layers[0].pixels.size(), codes.size());
    for (std::size_t i = 0; i < codes.size(); ++i) EXPECT_EQ(read.layers[0].pixels[i], codes[i] / 255.0f);
    for (std::size_t cut = 0; cut < size; ++cut) EXPECT_THROW(read_image("a.webp", encoded, cut), Error) << cut;
    WebPFree(encoded);
}

TEST(Stb, ReadsPnmInBothDepths)
{
    const std::string narrow = "P6\n2 1\n255\n\x01\x02\x03\xff\x80" + std::string(1, '\0');
    const Image a = read_image("a.ppm", narrow.data(), narrow.size());
    EXPECT_EQ(a.layers[0].pixels, (std::vector<float>{1 / 255.f, 2 / 255.f, 3 / 255.f, 1, 128 / 255.f, 0}));
    const std::string wide = std::string("P5\n2 1\n65535\n") + "\x01\x02\xff\xff";
    const Image b = read_image("b.pgm", wide.data(), wide.size());
    EXPECT_EQ(b.layers[0].channels, std::vector<std::string>{"Y"});
    EXPECT_EQ(b.layers[0].pixels, (std::vector<float>{258 / 65535.f, 1}));
    for (const std::string& whole : {narrow, wide})
        for (std::size_t cut = 0; cut < whole.size(); ++cut)
            EXPECT_THROW(read_image("cut", whole.data(), cut), Error) << cut;
}

// Files made by other programs are tested byte by byte, because a reader and a writer could share an error.

const unsigned char png_of_16_bits[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x06, 0x00, 0x00, 0x00, 0xa4, 0xb2, 0xa3, 0xc9, 0x00,
    0x00, 0x00, 0x19, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x64, 0xfa, 0xff, 0xbf, 0x81, 0x41,
    0xc8, 0x84, 0x81, 0x81, 0x81, 0x71, 0xf5, 0xd9, 0xff, 0x0c, 0x00, 0x2a, 0xc2, 0x05, 0x40, 0xad, 0x9b,
    0x46, 0x0c, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
const unsigned char png_of_8_bits[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00, 0x00, 0x7b, 0x40, 0xe8, 0xdd, 0x00, 0x00, 0x00,
    0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x60, 0x64, 0x62, 0xfe, 0xdf, 0xc0, 0x00, 0x00, 0x04, 0x20,
    0x01, 0x86, 0x71, 0x80, 0xaf, 0x9f, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
const unsigned char hdr_of_two_pixels[] = {
    0x23, 0x3f, 0x52, 0x41, 0x44, 0x49, 0x41, 0x4e, 0x43, 0x45, 0x0a, 0x46, 0x4f, 0x52, 0x4d, 0x41, 0x54, 0x3d,
    0x33, 0x32, 0x2d, 0x62, 0x69, 0x74, 0x5f, 0x72, 0x6c, 0x65, 0x5f, 0x72, 0x67, 0x62, 0x65, 0x0a, 0x0a, 0x2d,
    0x59, 0x20, 0x31, 0x20, 0x2b, 0x58, 0x20, 0x32, 0x0a, 0x80, 0x40, 0x20, 0x81, 0xff, 0x00, 0x01, 0x78};

TEST(ForeignFiles, PngHasItsHighByteFirst)
{
    const Image wide = read_image("16.png", png_of_16_bits, sizeof png_of_16_bits);
    EXPECT_EQ(wide.layers[0].channels, (std::vector<std::string>{"R", "G", "B", "A"}));
    const double codes[] = {0x0102, 0xffff, 0x8000, 0x1234, 0, 1, 0xabcd, 0xff00};
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(wide.layers[0].pixels.at(i), float(codes[i]) / 65535) << i;
    const Image narrow = read_image("8.png", png_of_8_bits, sizeof png_of_8_bits);
    const double bytes[] = {1, 2, 3, 255, 128, 0};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(narrow.layers[0].pixels.at(i), float(bytes[i]) / 255) << i;
    EXPECT_FALSE(wide.is_linear);
}

/// Pixels of RGBE have mantissas of red, green, blue, and a shared exponent with bias 128.
TEST(ForeignFiles, HdrSharesAnExponent)
{
    const Image image = read_image("a.hdr", hdr_of_two_pixels, sizeof hdr_of_two_pixels);
    const double expected[] = {1, 0.5, 0.25, std::ldexp(255, -16), 0, std::ldexp(1, -16)};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(image.layers[0].pixels.at(i), float(expected[i])) << i;
    EXPECT_TRUE(image.is_linear);
}

/// Files begin with the bytes that the formats specify: the first pixel of an uncompressed PNG row, of an HDR, of an
/// EXR.
TEST(ForeignFiles, WhatIsWrittenIsWhatTheFormatsSay)
{
    const TemporaryFolder folder;
    Image image = make_test_image(2, 1);
    image.layers[0].pixels = {1, 0.5f, 0.25f, 4, 2, 1};
    write_image(folder.path() / "a.hdr", image, {});
    const std::vector<char> hdr = test::bytes_of(folder.path() / "a.hdr");
    const std::vector<unsigned char> end(hdr.end() - 8, hdr.end());
    EXPECT_EQ(end, (std::vector<unsigned char>{128, 64, 32, 129, 128, 64, 32, 131}));
    write_image(folder.path() / "a.exr", image, {});
    const std::vector<char> exr = test::bytes_of(folder.path() / "a.exr");
    // EXR sorts channels by name; B, G and R each have a row of their own.
    float values[6];
    std::memcpy(values, &exr[exr.size() - sizeof values], sizeof values);
    const float expected[] = {0.25f, 1, 0.5f, 2, 1, 4};
    for (int i = 0; i < 6; ++i) EXPECT_EQ(values[i], expected[i]) << i;
}

/// Exposure and tone mapping apply to display formats only: EXR and HDR keep radiance.
TEST(WriteOptions, ExposureIsForDisplays)
{
    Image image = make_test_image(1, 1);
    image.layers[0].pixels = {0.25f, 0.5f, 0.125f};
    WriteOptions options;
    options.display = {1, Tonemap::srgb};
    options.png_bits = 16;
    EXPECT_EQ(written_and_read(image, "a.exr", options).layers[0].pixels, image.layers[0].pixels);
    EXPECT_EQ(written_and_read(image, "a.hdr", options).layers[0].pixels, image.layers[0].pixels);
    const Image png = written_and_read(image, "a.png", options);
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(png.layers[0].pixels[c], test::srgb(2 * double(image.layers[0].pixels[c])), 1e-5);
}

TEST(ReadImage, ReportsErrors)
{
    const TemporaryFolder folder;
    const auto message = [](const std::filesystem::path& file) -> std::string {
        try {
            read_image(file);
        } catch (const Error& error) {
            EXPECT_EQ(error.file(), file.string());
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            return error.message();
        }
        return "nothing";
    };
    EXPECT_EQ(message(folder.path() / "missing.png"), "there is no such file");
    EXPECT_EQ(message(folder.path()), "this is a folder, not an image");
    std::ofstream(folder.path() / "empty.png").flush();
    EXPECT_EQ(message(folder.path() / "empty.png"), "the file is empty");
    std::ofstream(folder.path() / "text.png") << "Not a picture at all, but a long enough text.";
    EXPECT_NE(message(folder.path() / "text.png").find("not an image in a supported format"), std::string::npos);
}

}  // namespace
}  // namespace fathom
