// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>

// jpeglib.h must follow the headers above, which it needs but doesn't include.
#include <jpeglib.h>

#include <jerror.h>

#include "fathom/error.h"
#include "image/codecs/codecs.h"
#include "image/codes.h"
#include "image/color/tonemap.h"

// libjpeg reports errors by longjmp, as libpng does: functions that it may jump out of hold no objects with
// destructors; their callers hold them.
namespace fathom {

namespace {

struct ErrorManager {
    jpeg_error_mgr base;
    std::jmp_buf jump;
    char message[JMSG_LENGTH_MAX];
};

[[noreturn]] void on_error(j_common_ptr jpeg)
{
    auto* manager = reinterpret_cast<ErrorManager*>(jpeg->err);
    jpeg->err->format_message(jpeg, manager->message);
    std::longjmp(manager->jump, 1);
}

void on_message(j_common_ptr jpeg, int level)
{
    if (level >= 0) return;
    // Stray bytes between segments and unknown markers leave the image intact. Other warnings mean damage, which
    // libjpeg would fill with gray.
    switch (jpeg->err->msg_code) {
        case JWRN_ADOBE_XFORM:
        case JWRN_BOGUS_ICC:
        case JWRN_EXTRANEOUS_DATA:
        case JWRN_JFIF_MAJOR:
        case JWRN_NOT_SEQUENTIAL:
            return;
        default:
            on_error(jpeg);
    }
}

jpeg_error_mgr* set_up(ErrorManager& manager)
{
    jpeg_error_mgr* base = jpeg_std_error(&manager.base);
    base->error_exit = on_error;
    base->emit_message = on_message;
    return base;
}

struct Decompressor {
    jpeg_decompress_struct jpeg{};
    ErrorManager manager{};
    bool created = false;
    ~Decompressor()
    {
        if (created) jpeg_destroy_decompress(&jpeg);
    }
};

bool read_header(Decompressor& d, const EncodedImage& file)
{
    d.jpeg.err = set_up(d.manager);
    if (setjmp(d.manager.jump)) return false;
    jpeg_create_decompress(&d.jpeg);
    d.created = true;
    jpeg_mem_src(&d.jpeg, file.bytes, static_cast<unsigned long>(file.size));
    jpeg_read_header(&d.jpeg, TRUE);
    const bool has_black = d.jpeg.jpeg_color_space == JCS_CMYK || d.jpeg.jpeg_color_space == JCS_YCCK;
    // Four channels, as textures have; libjpeg-turbo sets alpha to opaque.
    d.jpeg.out_color_space = has_black ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg_calc_output_dimensions(&d.jpeg);
    return true;
}

/// Decodes into `codes`, with interleaved channels. False after an error.
bool read_rows(Decompressor& d, unsigned char* codes)
{
    if (setjmp(d.manager.jump)) return false;
    jpeg_start_decompress(&d.jpeg);
    const std::size_t count = std::size_t(d.jpeg.output_width) * std::size_t(d.jpeg.output_components);
    while (d.jpeg.output_scanline < d.jpeg.output_height) {
        JSAMPROW rows[1] = {codes + count * d.jpeg.output_scanline};
        jpeg_read_scanlines(&d.jpeg, rows, 1);
    }
    jpeg_finish_decompress(&d.jpeg);
    return true;
}

struct Compressor {
    jpeg_compress_struct jpeg{};
    ErrorManager manager{};
    bool created = false;
    unsigned char* encoded = nullptr;
    unsigned long size = 0;
    ~Compressor()
    {
        if (created) jpeg_destroy_compress(&jpeg);
        std::free(encoded);
    }
};

bool write_rows(Compressor& c, const Image& image, int quality, unsigned char* codes)
{
    c.jpeg.err = set_up(c.manager);
    if (setjmp(c.manager.jump)) return false;
    jpeg_create_compress(&c.jpeg);
    c.created = true;
    jpeg_mem_dest(&c.jpeg, &c.encoded, &c.size);
    c.jpeg.image_width = JDIMENSION(image.width);
    c.jpeg.image_height = JDIMENSION(image.height);
    c.jpeg.input_components = 3;
    c.jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&c.jpeg);
    jpeg_set_quality(&c.jpeg, quality, TRUE);
    // Chroma is stored at full resolution, so that noise and edges keep their color.
    c.jpeg.comp_info[0].h_samp_factor = c.jpeg.comp_info[0].v_samp_factor = 1;
    jpeg_start_compress(&c.jpeg, TRUE);
    while (c.jpeg.next_scanline < c.jpeg.image_height) {
        JSAMPROW rows[1] = {codes + std::size_t(c.jpeg.next_scanline) * std::size_t(image.width) * 3};
        jpeg_write_scanlines(&c.jpeg, rows, 1);
    }
    jpeg_finish_compress(&c.jpeg);
    return true;
}

/// Converts Adobe's inverted CMYK, the usual kind in JPEG: each value is the fraction of light that the ink transmits.
Image rgb_from_cmyk(const ByteImage& cmyk)
{
    Image image = make_image(cmyk.width, cmyk.height, 3);
    std::vector<float>& out = image.layers[0].pixels;
    for (std::size_t i = 0; i < cmyk.texels.size(); ++i) {
        const auto code = [&](std::size_t c) { return float(cmyk.texels[i] >> (8 * c) & 0xffu) / 255; };
        for (std::size_t c = 0; c < 3; ++c) out[3 * i + c] = code(c) * code(3);
    }
    return image;
}

}  // namespace

Picture read_jpeg(const EncodedImage& file)
{
    Decompressor d;
    if (!read_header(d, file)) throw Error(file.name, "", fmt::format("damaged JPEG: {}", d.manager.message));
    const bool is_cmyk = d.jpeg.out_color_space == JCS_CMYK;
    check_size(file, d.jpeg.output_width, d.jpeg.output_height, is_cmyk ? 4 + 3 * sizeof(float) : 4);
    const int channels = d.jpeg.jpeg_color_space == JCS_GRAYSCALE ? 1 : 3;
    ByteImage image(int(d.jpeg.output_width), int(d.jpeg.output_height), channels);
    if (!read_rows(d, image.bytes())) throw Error(file.name, "", fmt::format("damaged JPEG: {}", d.manager.message));
    if (is_cmyk) return rgb_from_cmyk(image);
    return image;
}

std::vector<unsigned char> encode_jpeg(const Image& image, const WriteOptions& options)
{
    const DisplayMap map(options.display);
    const Image::Layer& layer = image.layers[0];
    const DisplayChannels channels = display_channels(layer);
    std::vector<unsigned char> codes(std::size_t(image.width) * std::size_t(image.height) * 3);
    encode_pixels(layer, 3, codes.data(), [&](const float* pixel, unsigned char* code) {
        const auto rgb = map.codes8({pixel[channels.r], pixel[channels.g], pixel[channels.b]});
        std::copy(rgb.begin(), rgb.end(), code);
    });
    Compressor c;
    if (!write_rows(c, image, options.jpeg_quality, codes.data()))
        throw Error("", "", fmt::format("can't encode JPEG: {}", c.manager.message));
    return {c.encoded, c.encoded + c.size};
}

}  // namespace fathom
