#include "fathom/error.h"
#include "image/formats.h"

#ifdef FATHOM_HAS_BASIS
#include <basisu_transcoder.h>
#endif

namespace fathom {

#ifdef FATHOM_HAS_BASIS

Image read_ktx2(const EncodedImage& file)
{
    static const bool ready = (basist::basisu_transcoder_init(), true);
    static_cast<void>(ready);
    if (file.size > 0xffffffffu) throw Error(file.name, "", "a KTX2 of more than 4 GB");
    basist::ktx2_transcoder transcoder;
    if (!transcoder.init(file.bytes, std::uint32_t(file.size)))
        throw Error(file.name, "", "this KTX2 is damaged, or not packed by Basis Universal (ETC1S, UASTC)");
    if (transcoder.get_faces() != 1 || transcoder.get_layers() > 1)
        throw Error(file.name, "", "a KTX2 of several pictures, where one is wanted");
    const int width = int(transcoder.get_width()), height = int(transcoder.get_height());
    const int channels = transcoder.get_has_alpha() ? 4 : 3;
    check_size(file, std::uint64_t(transcoder.get_width()), std::uint64_t(transcoder.get_height()),
               std::uint64_t(channels) * sizeof(float) + 4);
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    std::vector<unsigned char> codes(4 * pixels);
    if (!transcoder.start_transcoding() ||
        !transcoder.transcode_image_level(0, 0, 0, codes.data(), std::uint32_t(pixels),
                                          basist::transcoder_texture_format::cTFRGBA32))
        throw Error(file.name, "", "damaged KTX2: the pixels can't be unpacked");
    Image image = make_image(width, height, channels);
    std::vector<float>& values = image.layers[0].pixels;
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < std::size_t(channels); ++c)
            values[i * std::size_t(channels) + c] = float(codes[4 * i + c]) / 255;
    return image;
}

#else

Image read_ktx2(const EncodedImage& file)
{
    throw Error(file.name, "", "this build reads no KTX2: it was made without Basis Universal (docs/formats.md)");
}

#endif

}  // namespace fathom
