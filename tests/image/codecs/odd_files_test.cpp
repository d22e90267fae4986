// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <png.h>
#include <sys/stat.h>

#include <cstring>

#include "fathom/error.h"
#include "image/pictures.h"
#include "support/memory_limit.h"

// Tests of valid or nearly valid files of forms that our writers never produce.
namespace fathom {
namespace {

using test::TemporaryFolder;

std::string error_of_image(const std::string& bytes)
{
    try {
        read_image("a", bytes.data(), bytes.size());
    } catch (const Error& error) {
        return error.message();
    }
    return "read";
}

/// Bytes of a value in little-endian order.
template <class T>
std::string raw(T value)
{
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// An OpenEXR file of 2 x 1 pixels with one integer channel.
std::string exr_of_integers()
{
    const auto attribute = [](const std::string& name, const std::string& type, const std::string& value) {
        return name + '\0' + type + '\0' + raw(std::int32_t(value.size())) + value;
    };
    const std::string box = raw(0) + raw(0) + raw(1) + raw(0), zero(1, '\0');
    std::string file = raw(20000630) + raw(2);
    file += attribute("channels", "chlist", "id" + zero + raw(0) + raw(0) + raw(1) + raw(1) + zero);
    file += attribute("compression", "compression", zero);
    file += attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box);
    file += attribute("lineOrder", "lineOrder", zero) + attribute("pixelAspectRatio", "float", raw(1.0f));
    file += attribute("screenWindowCenter", "v2f", raw(0.0f) + raw(0.0f));
    file += attribute("screenWindowWidth", "float", raw(1.0f)) + zero;
    file += raw(std::uint64_t(file.size() + 8));
    return file + raw(0) + raw(8) + raw(7) + raw(9);
}

TEST(Exr, WithoutAnythingButIntegersIsNoPicture)
{
    EXPECT_EQ(error_of_image(exr_of_integers()), "it contains no image: all its channels are integers, such as ids");
}

TEST(Exr, AttributesLongerThanTheFileAreNotBelieved)
{
    // The declared length of the "compression" attribute is two gigabytes.
    std::string file = exr_of_integers();
    const std::string name = std::string("compression") + '\0' + "compression" + '\0';
    const std::size_t at = file.find(name);
    ASSERT_NE(at, std::string::npos);
    file.replace(at, name.size() + 4, std::string("compression") + '\0' + "string" + '\0' + raw(0x7ffffff0));
    const test::MemoryLimit limit(rlim_t(1) << 30);
    EXPECT_EQ(error_of_image(file), "the file is truncated or damaged");
}

TEST(Exr, AttributesThatReachIntoTheNextAreNotBelieved)
{
    // OpenEXR ends a channel list or box early and parses the rest as an attribute, here a string of two gigabytes.
    const std::string zero(1, '\0'), text = "a" + zero + "string" + zero + raw(0x7ffffff0);
    const std::string good = exr_of_integers();
    for (const std::string& word : {"channels" + zero + "chlist" + zero, "dataWindow" + zero + "box2i" + zero}) {
        std::string file = good;
        const std::size_t at = file.find(word) + word.size();
        std::int32_t size = 0;
        std::memcpy(&size, &file[at], 4);
        file.insert(at + 4 + std::size_t(size), text);
        size += std::int32_t(text.size());
        std::memcpy(&file[at], &size, 4);
        const test::MemoryLimit limit(rlim_t(1) << 30);
        EXPECT_EQ(error_of_image(file), "the file is truncated or damaged") << word;
    }
}

/// A palette PNG of one color, which compresses extremely well.
std::string png_of_one_colour(int side, int bits, int colour_type)
{
    std::string bytes;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    const auto append = [](png_structp p, png_bytep data, std::size_t size) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(data), size);
    };
    png_set_write_fn(png, &bytes, append, nullptr);
    png_set_compression_level(png, 9);
    png_set_IHDR(png, info, png_uint_32(side), png_uint_32(side), bits, colour_type, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    const png_color palette[2] = {{51, 102, 255}, {0, 0, 0}};
    const png_byte alpha[2] = {255, 0};
    if (colour_type == PNG_COLOR_TYPE_PALETTE) {
        png_set_PLTE(png, info, palette, 2);
        png_set_tRNS(png, info, alpha, 2, nullptr);
    }
    png_write_info(png, info);
    const std::vector<png_byte> row(png_get_rowbytes(png, info), 0);
    for (int y = 0; y < side; ++y) png_write_row(png, row.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return bytes;
}

TEST(Png, PalettesOfFewBits)
{
    for (const int bits : {1, 2, 4, 8}) {
        const std::string bytes = png_of_one_colour(1500, bits, PNG_COLOR_TYPE_PALETTE);
        ASSERT_EQ(error_of_image(bytes), "read") << bits;
        const Image image = read_image("a", bytes.data(), bytes.size());
        EXPECT_EQ(image.width, 1500);
        ASSERT_EQ(image.layers.at(0).channels.size(), 4u);
        const std::vector<float> last(image.layers[0].pixels.end() - 4, image.layers[0].pixels.end());
        EXPECT_EQ(last, (std::vector<float>{0.2f, 0.4f, 1, 1}));
    }
    for (const int bits : {1, 2, 4, 8, 16})
        EXPECT_EQ(error_of_image(png_of_one_colour(1500, bits, PNG_COLOR_TYPE_GRAY)), "read") << bits;
}

TEST(Pnm, NumbersThatWrapAroundAreRefused)
{
    EXPECT_EQ(error_of_image("P6 2 2 255 abcdefghijkl"), "read");
    EXPECT_EQ(error_of_image("P6 #4294967298\n2 2 255 1234567890ab"), "read");
    // The width wraps around to 2 modulo 2^32.
    EXPECT_EQ(error_of_image("P6 4294967298 2 255 abcdefghijkl"), "damaged image: a number in its header is too large");
    EXPECT_EQ(error_of_image("P6 2 2 4294967551 abcdefghijkl"), "damaged image: a number in its header is too large");
}

TEST(ReadImage, RefusesPipesAndDevicesAtOnce)
{
    const TemporaryFolder folder;
    const std::filesystem::path pipe = folder.path() / "pipe.png";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    for (const std::filesystem::path& file : {pipe, std::filesystem::path("/dev/zero")}) {
        try {
            read_image(file);
            ADD_FAILURE() << file;
        } catch (const Error& error) {
            EXPECT_EQ(error.message(), "this is a device or a pipe, not an image");
        }
    }
}

}  // namespace
}  // namespace fathom
