// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include "fathom/error.h"
#include "image/codecs/codecs.h"

namespace fathom {

ByteImage read_webp(const EncodedImage& file)
{
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(file.bytes, file.size, &features) != VP8_STATUS_OK)
        throw Error(file.name, "", "damaged WebP: the header can't be read");
    if (features.has_animation) throw Error(file.name, "", "animated WebP is not supported");
    check_size(file, std::uint64_t(features.width), std::uint64_t(features.height), sizeof(std::uint32_t));
    ByteImage image(features.width, features.height, features.has_alpha ? 4 : 3);
    if (!WebPDecodeRGBAInto(file.bytes, file.size, image.bytes(), 4 * image.texels.size(), 4 * image.width))
        throw Error(file.name, "", "damaged WebP: the file is truncated or invalid");
    return image;
}

namespace {

struct Encoder {
    WebPConfig config;
    WebPPicture picture;
    WebPMemoryWriter writer;

    Encoder()
    {
        WebPConfigInit(&config);
        WebPPictureInit(&picture);
        WebPMemoryWriterInit(&writer);
        picture.writer = WebPMemoryWrite;
        picture.custom_ptr = &writer;
    }
    ~Encoder()
    {
        WebPPictureFree(&picture);
        WebPMemoryWriterClear(&writer);
    }
    Encoder(const Encoder&) = delete;
};

}  // namespace

std::vector<unsigned char> encode_webp(const Image& image, const WriteOptions& options)
{
    const std::vector<unsigned char> codes = to_display(image.layers[0], image.width, image.height, options.display);
    Encoder e;
    e.config.lossless = !options.webp_quality;
    e.config.exact = 1;  // keeps colors of fully transparent pixels
    if (options.webp_quality) e.config.quality = float(*options.webp_quality);
    e.picture.use_argb = e.config.lossless;
    e.picture.width = image.width;
    e.picture.height = image.height;
    if (!WebPPictureImportRGBA(&e.picture, codes.data(), image.width * 4) || !WebPEncode(&e.config, &e.picture))
        throw Error("", "", fmt::format("can't encode WebP: error {} of libwebp", int(e.picture.error_code)));
    return {e.writer.mem, e.writer.mem + e.writer.size};
}

}  // namespace fathom
