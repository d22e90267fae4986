// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <memory>

#include "fathom/error.h"
#include "fathom/memory.h"
#include "image/codecs/avif_library.h"
#include "image/codecs/codecs.h"

namespace fathom {

namespace {

using Decoder = std::unique_ptr<avifDecoder, decltype(&avifDecoderDestroy)>;

/// Pixels of four channels, the first in the lowest bits. Texels have 32 bits for channels of 8 bits, and 64 for
/// channels of 16.
template <class Texel>
struct Raster {
    int width, height;
    std::vector<Texel> texels;
};

/// Returns an image of this size whose pixels are `texel_at(x, y)`.
template <class Texel, class TexelAt>
Raster<Texel> remapped_pixels(int width, int height, TexelAt texel_at)
{
    Raster<Texel> to{width, height, {}};
    to.texels.reserve(std::size_t(width) * std::size_t(height));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) to.texels.push_back(texel_at(x, y));
    return to;
}

/// Applies clean aperture, rotation and mirroring, in this order, as the file demands (ISO/IEC 23000-22, 7.3.6.7).
template <class Texel>
Raster<Texel> transformed(Raster<Texel> raster, const EncodedImage& file, const avifImage& image)
{
    const auto from = [&](int x, int y) {
        return raster.texels[std::size_t(y) * std::size_t(raster.width) + std::size_t(x)];
    };
    if (image.transformFlags & AVIF_TRANSFORM_CLAP) {
        avifCropRect cut;
        avifDiagnostics why{};
        if (!avif_library().avifCropRectConvertCleanApertureBox(&cut, &image.clap, image.width, image.height,
                                                                image.yuvFormat, &why))
            throw Error(file.name, "", fmt::format("damaged AVIF: {}", why.error));
        raster = remapped_pixels<Texel>(int(cut.width), int(cut.height),
                                        [&](int x, int y) { return from(x + int(cut.x), y + int(cut.y)); });
    }
    const int quarters = image.transformFlags & AVIF_TRANSFORM_IROT ? image.irot.angle & 3 : 0;
    for (int i = 0; i < quarters; ++i)  // a quarter turn counterclockwise: the right side becomes the top
        raster = remapped_pixels<Texel>(raster.height, raster.width,
                                        [&](int x, int y) { return from(raster.width - 1 - y, x); });
    if (image.transformFlags & AVIF_TRANSFORM_IMIR) {
        // The only member is called `mode` or `axis`, depending on the version of libavif; 0 exchanges top and bottom
        // in both.
        const auto [sides] = image.imir;
        raster = remapped_pixels<Texel>(raster.width, raster.height, [&](int x, int y) {
            return sides ? from(raster.width - 1 - x, y) : from(x, raster.height - 1 - y);
        });
    }
    return raster;
}

/// Encoded colors and straight alpha, in the bit depth of the file.
template <class Texel>
Raster<Texel> decoded(const EncodedImage& file, const avifImage& image)
{
    Raster<Texel> raster{int(image.width), int(image.height),
                         std::vector<Texel>(std::size_t(image.width) * std::size_t(image.height))};
    avifRGBImage rgb;
    avif_library().avifRGBImageSetDefaults(&rgb, &image);
    rgb.chromaUpsampling = AVIF_CHROMA_UPSAMPLING_BILINEAR;
    rgb.avoidLibYUV = AVIF_TRUE;  // libyuv's results may differ between machines
    rgb.pixels = reinterpret_cast<std::uint8_t*>(raster.texels.data());
    rgb.rowBytes = image.width * std::uint32_t(sizeof(Texel));
    const avifResult result = avif_library().avifImageYUVToRGB(&image, &rgb);
    if (result != AVIF_RESULT_OK)
        throw Error(file.name, "",
                    fmt::format("this AVIF can't be read: {}", avif_library().avifResultToString(result)));
    return transformed(std::move(raster), file, image);
}

Image wide_image(const Raster<std::uint64_t>& raster, int channels, int bits)
{
    Image image = make_image(raster.width, raster.height, channels);
    const bool has_color = channels >= 3;
    const float largest = float((1 << bits) - 1);
    float* to = image.layers[0].pixels.data();
    for (const std::uint64_t texel : raster.texels)
        for (int c = 0; c < 4; ++c)
            if (c == 3 ? channels % 2 == 0 : has_color || c == 0) *to++ = float(texel >> (16 * c) & 0xffffu) / largest;
    return image;
}

void check(const EncodedImage& file, const Decoder& decoder, avifResult result)
{
    if (result == AVIF_RESULT_OK) return;
    const std::string_view detail = decoder->diag.error;
    throw Error(file.name, "",
                fmt::format("damaged AVIF: {}{}{}", avif_library().avifResultToString(result),
                            detail.empty() ? "" : ": ", detail));
}

/// Reads the header, which gives the size, and then the first image.
void read_into(const Decoder& decoder, const EncodedImage& file)
{
    decoder->ignoreExif = decoder->ignoreXMP = AVIF_TRUE;
    check(file, decoder, avif_library().avifDecoderSetIOMemory(decoder.get(), file.bytes, file.size));
    check(file, decoder, avif_library().avifDecoderParse(decoder.get()));
    const avifImage& image = *decoder->image;
    const std::uint64_t bytes_while_read =
        image.depth > 8 ? 32 : 16;  // planes, pixels, and a second copy of the pixels while rotating
    check_size(file, image.width, image.height, bytes_while_read);
    // The coded stream may claim another size than the header.
    const std::uint64_t memory = std::min(available_memory_bytes(), file.memory_limit);
    decoder->imageSizeLimit =
        std::uint32_t(std::clamp<std::uint64_t>(memory / bytes_while_read, 1, AVIF_DEFAULT_IMAGE_SIZE_LIMIT));
    check(file, decoder, avif_library().avifDecoderNextImage(decoder.get()));
    const auto transfer = image.transferCharacteristics;
    if (transfer == AVIF_TRANSFER_CHARACTERISTICS_SMPTE2084 || transfer == AVIF_TRANSFER_CHARACTERISTICS_HLG)
        throw Error(file.name, "", "AVIF with high dynamic range (PQ or HLG) is not supported: convert it to OpenEXR");
}

}  // namespace

bool is_avif(const EncodedImage& file)
{
    const avifROData data{file.bytes, file.size};
    return avif_library().avifPeekCompatibleFileType(&data);
}

Picture read_avif(const EncodedImage& file)
{
    const AvifLibrary& avif = avif_library();
    const Decoder decoder(avif.avifDecoderCreate(), avif.avifDecoderDestroy);
    read_into(decoder, file);
    const avifImage& image = *decoder->image;
    const int channels = (image.yuvFormat == AVIF_PIXEL_FORMAT_YUV400 ? 1 : 3) + (image.alphaPlane ? 1 : 0);
    if (image.depth > 8) return wide_image(decoded<std::uint64_t>(file, image), channels, int(image.depth));
    Raster<std::uint32_t> raster = decoded<std::uint32_t>(file, image);
    ByteImage picture(0, 0, channels);
    picture.width = raster.width;
    picture.height = raster.height;
    picture.texels = std::move(raster.texels);
    return picture;
}

std::vector<unsigned char> encode_avif(const Image& image, const WriteOptions& options)
{
    const AvifLibrary& avif = avif_library();
    std::vector<unsigned char> codes = to_display(image.layers[0], image.width, image.height, options.display);
    const std::unique_ptr<avifImage, decltype(&avifImageDestroy)> planes(
        avif.avifImageCreate(std::uint32_t(image.width), std::uint32_t(image.height), 8, AVIF_PIXEL_FORMAT_YUV444),
        avif.avifImageDestroy);
    if (!options.display.ocio) {  // the encoding of OpenColorIO's displays is unknown
        planes->colorPrimaries = AVIF_COLOR_PRIMARIES_BT709;
        planes->transferCharacteristics = AVIF_TRANSFER_CHARACTERISTICS_SRGB;
    }
    // Lossless encoding stores green, blue and red in the planes directly.
    const bool lossless = options.avif_quality == 100;
    planes->matrixCoefficients = lossless ? AVIF_MATRIX_COEFFICIENTS_IDENTITY : AVIF_MATRIX_COEFFICIENTS_BT601;
    avifRGBImage rgb;
    avif.avifRGBImageSetDefaults(&rgb, planes.get());
    rgb.ignoreAlpha = display_channels(image.layers[0]).a < 0;
    rgb.avoidLibYUV = AVIF_TRUE;
    rgb.pixels = codes.data();
    rgb.rowBytes = 4 * std::uint32_t(image.width);
    avifResult result = avif.avifImageRGBToYUV(planes.get(), &rgb);

    const std::unique_ptr<avifEncoder, decltype(&avifEncoderDestroy)> encoder(avif.avifEncoderCreate(),
                                                                              avif.avifEncoderDestroy);
    encoder->speed = 8;
    // libavif 1.0's mapping of quality: 100 is quantizer 0, and 0 is 63. Alpha is always lossless.
    encoder->minQuantizer = encoder->maxQuantizer = ((100 - options.avif_quality) * 63 + 50) / 100;
    encoder->minQuantizerAlpha = encoder->maxQuantizerAlpha = AVIF_QUANTIZER_LOSSLESS;
    avifRWData encoded = AVIF_DATA_EMPTY;
    if (result == AVIF_RESULT_OK) result = avif.avifEncoderWrite(encoder.get(), planes.get(), &encoded);
    const std::unique_ptr<avifRWData, decltype(&avifRWDataFree)> owner(&encoded, avif.avifRWDataFree);
    if (result != AVIF_RESULT_OK)
        throw Error("", "",
                    fmt::format("can't encode AVIF: {} {}", avif.avifResultToString(result), encoder->diag.error));
    return {encoded.data, encoded.data + encoded.size};
}

}  // namespace fathom
