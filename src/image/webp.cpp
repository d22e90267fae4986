#include <fmt/format.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include "fathom/error.h"
#include "image/formats.h"

namespace fathom {

Image read_webp(const EncodedImage& file)
{
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(file.bytes, file.size, &features) != VP8_STATUS_OK)
        throw Error(file.name, "", "damaged WebP: the header can't be read");
    if (features.has_animation) throw Error(file.name, "", "an animated WebP is not a picture");
    const int channels = features.has_alpha ? 4 : 3;
    check_size(file, std::uint64_t(features.width), std::uint64_t(features.height),
               std::uint64_t(channels) * (sizeof(float) + 1));
    Image image = make_image(features.width, features.height, channels);
    std::vector<float>& values = image.layers[0].pixels;
    std::vector<unsigned char> codes(values.size());
    const int stride = features.width * channels;
    const auto decode = channels == 4 ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
    if (!decode(file.bytes, file.size, codes.data(), codes.size(), stride))
        throw Error(file.name, "", "damaged WebP: the file is cut short or wrong");
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(codes[i]) / 255;
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
    e.config.exact = 1;  // colours where alpha is 0, too
    if (options.webp_quality) e.config.quality = float(*options.webp_quality);
    e.picture.use_argb = e.config.lossless;
    e.picture.width = image.width;
    e.picture.height = image.height;
    if (!WebPPictureImportRGBA(&e.picture, codes.data(), image.width * 4) || !WebPEncode(&e.config, &e.picture))
        throw Error("", "", fmt::format("can't encode WebP: error {} of libwebp", int(e.picture.error_code)));
    return {e.writer.mem, e.writer.mem + e.writer.size};
}

}  // namespace fathom
