// SPDX-License-Identifier: Apache-2.0
#include "fathom/error.h"
#include "image/codecs/codecs.h"

#ifdef FATHOM_HAS_BASIS
#include <basisu_transcoder.h>
#endif

namespace fathom {

#ifdef FATHOM_HAS_BASIS

ByteImage read_ktx2(const EncodedImage& file)
{
    static const bool ready = (basist::basisu_transcoder_init(), true);
    static_cast<void>(ready);
    if (file.size > 0xffffffffu) throw Error(file.name, "", "KTX2 files larger than 4 GB are not supported");
    basist::ktx2_transcoder transcoder;
    if (!transcoder.init(file.bytes, std::uint32_t(file.size)))
        throw Error(file.name, "", "this KTX2 is damaged, or not compressed by Basis Universal (ETC1S, UASTC)");
    if (transcoder.get_faces() != 1 || transcoder.get_layers() > 1)
        throw Error(file.name, "", "KTX2 files with several images are not supported");
    const int width = int(transcoder.get_width()), height = int(transcoder.get_height());
    const int channels = transcoder.get_has_alpha() ? 4 : 3;
    check_size(file, std::uint64_t(transcoder.get_width()), std::uint64_t(transcoder.get_height()),
               sizeof(std::uint32_t));
    ByteImage image(width, height, channels);
    if (!transcoder.start_transcoding() ||
        !transcoder.transcode_image_level(0, 0, 0, image.bytes(), std::uint32_t(image.texels.size()),
                                          basist::transcoder_texture_format::cTFRGBA32))
        throw Error(file.name, "", "damaged KTX2: the pixels can't be decoded");
    return image;
}

#else

ByteImage read_ktx2(const EncodedImage& file)
{
    throw Error(file.name, "",
                "this build does not support KTX2: it was built without Basis Universal (docs/formats.md)");
}

#endif

}  // namespace fathom
