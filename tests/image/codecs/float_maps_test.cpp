// SPDX-License-Identifier: Apache-2.0
// Tests of Radiance HDR and portable float maps (PFM), byte by byte.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "fathom/error.h"
#include "image/color/primaries.h"
#include "image/pictures.h"

namespace fathom {
namespace {

Image read(const std::string& bytes)
{
    return read_image("a", bytes.data(), bytes.size());
}

std::string error_of(const std::string& bytes)
{
    try {
        read(bytes);
    } catch (const Error& error) {
        return (error.place().empty() ? "" : error.place() + ": ") + error.message();
    }
    return "read";
}

/// An HDR file whose scanlines have codes (r, g, 0, 128): (r / 256, g / 256, 0), where r numbers the scanline and g the
/// pixel in it.
std::string hdr(const std::string& header, const std::string& resolution, int runs, int length)
{
    std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + header + "\n" + resolution + "\n";
    for (int run = 0; run < runs; ++run)
        for (int pixel = 0; pixel < length; ++pixel)
            for (const int part : {10 + run, 20 + pixel, 0, 128}) bytes += char(part);
    return bytes;
}

/// The first axis of the resolution line is that of scanlines; X grows to the right, Y upwards (Radiance file format
/// manual).
TEST(Hdr, EveryOrientation)
{
    for (const bool columns : {false, true})
        for (const char first : {'+', '-'})
            for (const char second : {'+', '-'}) {
                const int runs = 3, length = 5;
                const std::string resolution = fmt::format("{}{} {} {}{} {}", first, columns ? 'X' : 'Y', runs, second,
                                                           columns ? 'Y' : 'X', length);
                const Image image = read(hdr("", resolution, runs, length));
                ASSERT_EQ(image.width, columns ? runs : length);
                ASSERT_EQ(image.height, columns ? length : runs);
                for (int run = 0; run < runs; ++run)
                    for (int pixel = 0; pixel < length; ++pixel) {
                        const int x = columns ? (first == '+' ? run : runs - 1 - run)
                                              : (second == '+' ? pixel : length - 1 - pixel);
                        const int y = columns ? (second == '-' ? pixel : length - 1 - pixel)
                                              : (first == '-' ? run : runs - 1 - run);
                        const float* const value =
                            &image.layers[0].pixels[3 * (std::size_t(y) * std::size_t(image.width) + std::size_t(x))];
                        EXPECT_EQ(value[0], float(10 + run) / 256) << resolution;
                        EXPECT_EQ(value[1], float(20 + pixel) / 256) << resolution;
                    }
            }
    for (const char* const wrong : {"-Y 1 +Y 1", "-X 1 +X 1", "Y 1 X 1", "-Y 0 +X 1", "-Y 1", "*Y 1 +X 1", ""})
        EXPECT_EQ(error_of(hdr("", wrong, 1, 1)),
                  fmt::format("damaged HDR: expected a size such as '-Y 600 +X 800', found '{}'", wrong));
}

/// Values are divided by the product of all EXPOSURE and COLORCORR lines (Radiance file format manual).
TEST(Hdr, ExposureIsDividedOut)
{
    const auto first_pixel = [&](const std::string& header) {
        const std::vector<float> pixels = read(hdr(header, "-Y 1 +X 1", 1, 1)).layers.at(0).pixels;
        return std::pair(pixels.at(0), pixels.at(1));
    };
    const float r = 10 / 256.f, g = 20 / 256.f;
    EXPECT_EQ(first_pixel(""), std::pair(r, g));
    EXPECT_EQ(first_pixel("EXPOSURE=2\n"), std::pair(r / 2, g / 2));
    EXPECT_EQ(first_pixel("EXPOSURE= 2.0e+00\r\nVIEW=x\nEXPOSURE=2\n"), std::pair(r / 4, g / 4));
    EXPECT_EQ(first_pixel("EXPOSURE=0.25\nCOLORCORR= 2 0.5 1\n"), std::pair(r * 2, g * 8));
    for (const char* const none : {"EXPOSURE=\n", "EXPOSURE=0\n", "EXPOSURE=-1\n", "EXPOSURE=nan\n", "COLORCORR=2 2\n"})
        EXPECT_EQ(first_pixel(none), std::pair(r, g)) << none;
}

TEST(Hdr, PrimariesAreThoseOfTheHeader)
{
    EXPECT_FALSE(read(hdr("", "-Y 1 +X 1", 1, 1)).chromaticities.has_value());
    const auto found =
        read(hdr("PRIMARIES= 0.68 0.32 0.265 0.69 0.15 0.06 0.3127 0.329\n", "-Y 1 +X 1", 1, 1)).chromaticities;
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(is_same(*found, {{0.68f, 0.32f}, {0.265f, 0.69f}, {0.15f, 0.06f}, {0.3127f, 0.329f}}));
    EXPECT_EQ(error_of(hdr("PRIMARIES=0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3\n", "-Y 1 +X 1", 1, 1)),
              "PRIMARIES: these primaries don't span a color space");
}

std::string floats(const std::vector<float>& values, bool is_little_endian)
{
    std::string bytes;
    for (const float value : values) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        for (int i = 0; i < 4; ++i) bytes += char(bits >> (8 * (is_little_endian ? i : 3 - i)));
    }
    return bytes;
}

/// Rows are stored bottom up; the sign of the scale gives the byte order.
TEST(Pfm, RowsBytesAndScale)
{
    const std::vector<float> color = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, -12};
    const std::vector<float> turned = {7, 8, 9, 10, 11, -12, 1, 2, 3, 4, 5, 6};
    for (const bool little : {false, true})
        for (const double scale : {1.0, 0.5, 4.0}) {
            const std::string sign = little ? "-" : "";
            const Image image = read(fmt::format("PF\n2 2\n{}{:.1f}\n", sign, scale) + floats(color, little));
            ASSERT_EQ(image.width, 2);
            ASSERT_EQ(image.height, 2);
            EXPECT_TRUE(image.is_linear);
            EXPECT_EQ(image.layers.at(0).channels, (std::vector<std::string>{"R", "G", "B"}));
            for (std::size_t i = 0; i < turned.size(); ++i)
                EXPECT_EQ(image.layers[0].pixels[i], float(scale) * turned[i]) << little << scale << i;
        }
    const Image gray = read("Pf\n3 2\n-1\n" + floats({1, 2, 3, 4, 5, 6}, true));
    EXPECT_EQ(gray.layers.at(0).channels, (std::vector<std::string>{"Y"}));
    EXPECT_EQ(gray.layers[0].pixels, (std::vector<float>{4, 5, 6, 1, 2, 3}));
    const Image four = read("PF4\n1 1\n-1\n" + floats({1, 2, 3, 0.5f}, true));
    EXPECT_EQ(four.layers.at(0).channels, (std::vector<std::string>{"R", "G", "B", "A"}));
}

/// Exactly one blank ends the header: the first value may begin with the byte of a blank.
TEST(Pfm, HeadersAsProgramsWriteThem)
{
    const std::string first_is_newline = "\n\n\n\n" + floats({2}, true);
    const float newline = std::bit_cast<float>(0x0a0a0a0au);
    for (const char* const header :
         {"Pf\n2 1\n-1.0\n", "Pf 2 1 -1.0 ", "Pf\r\n2 1\r\n-1.0\r\n", "Pf\n# made by hand\n2 1 # size\n-1.000000e+00\n",
          "Pf# 9 9\n2\n1\n-1e0\t", "Pf \n \t2  1\n\n -1\n", "Pf\n2 1\n-1.0\r"}) {
        const Image image = read(header + first_is_newline);
        EXPECT_EQ(image.layers.at(0).pixels, (std::vector<float>{newline, 2})) << header;
    }
    const std::string big = "Pf\n1 1\n+1\n" + floats({3}, false);
    EXPECT_EQ(read(big).layers.at(0).pixels.at(0), 3);
}

TEST(Pfm, Mistakes)
{
    const std::string whole = "PF\n2 2\n-1\n" + floats(std::vector<float>(12, 1), true);
    EXPECT_EQ(error_of(whole), "read");
    for (std::size_t size = 2; size < whole.size(); ++size) EXPECT_NE(error_of(whole.substr(0, size)), "read") << size;
    EXPECT_EQ(error_of(whole.substr(0, whole.size() - 1)), "the file is truncated");
    EXPECT_EQ(error_of("PF\n-2 2\n-1\n"), "damaged PFM: expected a size, found '-2'");
    EXPECT_EQ(error_of("PF\n2 x\n-1\n"), "damaged PFM: expected a size, found 'x'");
    for (const char* const scale : {"0", "nan", "inf", "x", ""})
        EXPECT_EQ(error_of(fmt::format("PF\n2 2\n{}\n", scale)),
                  fmt::format("damaged PFM: expected a scale other than 0, found '{}'", scale));
    EXPECT_NE(error_of("PF\n2000000000 2000000000\n-1\n"), "read");
}

}  // namespace
}  // namespace fathom
