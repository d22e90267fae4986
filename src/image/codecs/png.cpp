// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <png.h>
#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <stdexcept>

#include "base/output_file.h"
#include "fathom/error.h"
#include "fathom/gray_image.h"
#include "image/codecs/codecs.h"
#include "image/codes.h"
#include "image/color/tonemap.h"

// libpng reports errors by longjmp. Functions that it may jump out of hold no objects with destructors; their callers
// hold them.
namespace fathom {

namespace {

struct Source {
    const unsigned char* bytes;
    std::size_t size, position;
};

struct Failure {
    char message[200];
};

void on_error(png_structp png, png_const_charp message)
{
    auto* failure = static_cast<Failure*>(png_get_error_ptr(png));
    std::strncpy(failure->message, message, sizeof failure->message - 1);
    png_longjmp(png, 1);
}
void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep destination, std::size_t size)
{
    auto* source = static_cast<Source*>(png_get_io_ptr(png));
    if (size > source->size - source->position) png_error(png, "the file is truncated");
    std::memcpy(destination, source->bytes + source->position, size);
    source->position += size;
}

void on_write(png_structp png, png_bytep bytes, std::size_t size)
{
    auto* encoded = static_cast<std::vector<unsigned char>*>(png_get_io_ptr(png));
    bool fits = true;
    try {
        encoded->insert(encoded->end(), bytes, bytes + size);
    } catch (...) {
        fits = false;
    }
    if (!fits) png_error(png, "not enough memory");
}
void on_flush(png_structp) {}

struct Reader {
    png_structp png = nullptr;
    png_infop info = nullptr;
    Failure failure{};
    std::size_t stored_row_bytes = 0;
    int channels = 0;  ///< channels of the file; transparency counts as alpha

    Reader()
    {
        png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
        if (png) info = png_create_info_struct(png);
        if (!info) throw std::bad_alloc();
    }
    ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

bool read_header(Reader& reader, Source& source)
{
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_set_read_fn(reader.png, &source, on_read);
    png_read_info(reader.png, reader.info);
    reader.stored_row_bytes = png_get_rowbytes(reader.png, reader.info);
    // Palettes, 1 to 4 bits and transparent colors are expanded to 8 bits and always four channels, as textures have;
    // 16-bit values are swapped to this machine's byte order.
    const int type = png_get_color_type(reader.png, reader.info);
    const bool is_colored = type & PNG_COLOR_MASK_COLOR;
    const bool has_alpha = type & PNG_COLOR_MASK_ALPHA || png_get_valid(reader.png, reader.info, PNG_INFO_tRNS);
    reader.channels = (is_colored ? 3 : 1) + (has_alpha ? 1 : 0);
    png_set_expand(reader.png);
    if (png_get_bit_depth(reader.png, reader.info) == 16) {
        png_set_swap(reader.png);
    } else {
        png_set_gray_to_rgb(reader.png);
        if (!has_alpha) png_set_filler(reader.png, 255, PNG_FILLER_AFTER);
    }
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    return true;
}

bool read_rows(Reader& reader, png_bytepp rows)
{
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

struct Writer {
    png_structp png = nullptr;
    png_infop info = nullptr;
    Failure failure{};

    Writer()
    {
        png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
        if (png) info = png_create_info_struct(png);
        if (!info) throw std::bad_alloc();
    }
    ~Writer() { png_destroy_write_struct(&png, &info); }
};

/// Layout of a PNG file.
struct PngLayout {
    int width, height, bits, color_type;
    bool is_srgb;
};

bool write_rows(Writer& writer, std::vector<unsigned char>& encoded, const PngLayout& layout, png_bytepp rows)
{
    if (setjmp(png_jmpbuf(writer.png))) return false;
    png_set_write_fn(writer.png, &encoded, on_write, on_flush);
    png_set_user_limits(writer.png, 0x7fffffff, 0x7fffffff);
    // Level 3 was chosen by measurements on 800x600 of noise, in ms and MB: level 1 45, 1.4; level 3 45, 1.4; level 6
    // with all filters 67, 1.4.
    png_set_compression_level(writer.png, 3);
    png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_IHDR(writer.png, writer.info, png_uint_32(layout.width), png_uint_32(layout.height), layout.bits,
                 layout.color_type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (layout.is_srgb) png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_RELATIVE);
    png_write_info(writer.png, writer.info);
    if (layout.bits == 16) png_set_swap(writer.png);
    png_write_image(writer.png, rows);
    png_write_end(writer.png, writer.info);
    return true;
}

/// Fills `codes` from the first layer with R G B or R G B A and straight alpha; 16-bit codes are in this machine's byte
/// order.
template <class Code, class Light, class Unit>
void fill_straight(const Image::Layer& layer, bool alpha, Code* codes, Light light, Unit unit)
{
    const DisplayChannels channels = display_channels(layer);
    encode_pixels(layer, alpha ? 4 : 3, codes, [&](const float* pixel, Code* code) {
        const float a = alpha ? pixel[channels.a] : 1;
        const float straight = a > 0 ? 1 / a : 0;
        const auto rgb =
            light({pixel[channels.r] * straight, pixel[channels.g] * straight, pixel[channels.b] * straight});
        std::copy(rgb.begin(), rgb.end(), code);
        if (alpha) code[3] = unit(a);
    });
}

/// Encodes rows of codes, which are in this machine's byte order.
std::vector<unsigned char> encode_rows(const PngLayout& layout, unsigned char* codes, std::size_t row_bytes)
{
    std::vector<png_bytep> rows(std::size_t(layout.height));
    for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = codes + y * row_bytes;
    Writer writer;
    std::vector<unsigned char> encoded;
    if (!write_rows(writer, encoded, layout, rows.data()))
        throw Error("", "", fmt::format("can't encode PNG: {}", writer.failure.message));
    return encoded;
}

}  // namespace

Picture read_png(const EncodedImage& file)
{
    Reader reader;
    Source source{file.bytes, file.size, 0};
    if (!read_header(reader, source))
        throw Error(file.name, "", fmt::format("damaged PNG: {}", reader.failure.message));
    const std::size_t width = png_get_image_width(reader.png, reader.info);
    const std::size_t height = png_get_image_height(reader.png, reader.info);
    const bool wide = png_get_bit_depth(reader.png, reader.info) == 16;
    const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
    check_size(file, width, height, wide ? std::size_t(reader.channels) * (sizeof(float) + 2) : 4);
    // Deflate expands one byte to at most 1032, so a short file that claims a huge image is rejected before memory is
    // allocated.
    if (double(reader.stored_row_bytes) * double(height) > 1032.0 * double(file.size))
        throw Error(file.name, "",
                    fmt::format("damaged PNG: {} bytes can't hold {}x{} pixels", file.size, width, height));
    const auto read_into = [&](unsigned char* codes) {
        std::vector<png_bytep> rows(height);
        for (std::size_t y = 0; y < height; ++y) rows[y] = codes + y * row_bytes;
        if (!read_rows(reader, rows.data()))
            throw Error(file.name, "", fmt::format("damaged PNG: {}", reader.failure.message));
    };
    if (!wide) {
        ByteImage image(int(width), int(height), reader.channels);
        read_into(image.bytes());
        return image;
    }
    std::vector<std::uint16_t> codes(row_bytes / 2 * height);
    read_into(reinterpret_cast<unsigned char*>(codes.data()));
    Image image = make_image(int(width), int(height), reader.channels);
    std::transform(codes.begin(), codes.end(), image.layers[0].pixels.begin(),
                   [](std::uint16_t code) { return float(code) / 65535; });
    return image;
}

std::vector<unsigned char> encode_png(const Image& image, const WriteOptions& options)
{
    const DisplayMap map(options.display);
    const bool alpha = display_channels(image.layers[0]).a >= 0, wide = options.png_bits == 16;
    const std::size_t height = std::size_t(image.height);
    const std::size_t row_bytes = std::size_t(image.width) * (alpha ? 4 : 3) * (wide ? 2 : 1);
    std::vector<std::uint16_t> codes((row_bytes * height + 1) / 2);
    auto* bytes = reinterpret_cast<unsigned char*>(codes.data());
    if (wide)
        fill_straight(image.layers[0], alpha, codes.data(), [&](const Color& c) { return map.codes16(c); }, unit16);
    else
        fill_straight(image.layers[0], alpha, bytes, [&](const Color& c) { return map.codes8(c); }, unit8);
    const PngLayout layout{image.width, image.height, wide ? 16 : 8,
                           alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, !options.display.ocio};
    return encode_rows(layout, bytes, row_bytes);
}

void write_gray_png(const std::filesystem::path& file, int width, int height, int bits,
                    const std::vector<std::uint16_t>& values)
{
    if (width < 1 || height < 1 || values.size() != std::size_t(width) * std::size_t(height))
        throw std::invalid_argument("the number of values is not that of the pixels");
    if (bits != 8 && bits != 16) throw std::invalid_argument("a gray PNG has 8 or 16 bits");
    std::vector<std::uint16_t> codes = values;
    auto* bytes = reinterpret_cast<unsigned char*>(codes.data());
    if (bits == 8) std::copy(values.begin(), values.end(), bytes);
    const PngLayout layout{width, height, bits, PNG_COLOR_TYPE_GRAY, false};
    OutputFile output(file);
    output.write(encode_rows(layout, bytes, std::size_t(width) * std::size_t(bits / 8)));
    output.commit();
}

}  // namespace fathom
