#include <fmt/format.h>
#include <webp/decode.h>

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

}  // namespace fathom
