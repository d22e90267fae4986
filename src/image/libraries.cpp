// SPDX-License-Identifier: Apache-2.0
#include <OpenEXRConfig.h>
#include <avif/avif.h>
#include <fmt/format.h>
#include <jpeglib.h>
#include <png.h>
#include <webp/decode.h>
#ifdef FATHOM_HAS_OCIO
#include <OpenColorIO/OpenColorIO.h>
#endif
#include <cstdio>

#include "fathom/image.h"

#define FATHOM_TEXT_OF(x) #x
#define FATHOM_TEXT(x) FATHOM_TEXT_OF(x)

namespace fathom {

std::vector<std::string> image_libraries()
{
    const int webp = WebPGetDecoderVersion();
    std::vector<std::string> libraries = {
        fmt::format("OpenEXR {}", OPENEXR_VERSION_STRING),
        fmt::format("libpng {}", png_get_libpng_ver(nullptr)),
        fmt::format("libjpeg-turbo {}", FATHOM_TEXT(LIBJPEG_TURBO_VERSION)),
        fmt::format("libwebp {}.{}.{}", webp >> 16, webp >> 8 & 255, webp & 255),
        fmt::format("libavif {}.{}.{}", AVIF_VERSION_MAJOR, AVIF_VERSION_MINOR, AVIF_VERSION_PATCH),
        "stb_image"};
#ifdef FATHOM_HAS_OCIO
    libraries.push_back(fmt::format("OpenColorIO {}", OCIO_NAMESPACE::GetVersion()));
#endif
#ifdef FATHOM_HAS_BASIS
    libraries.push_back("Basis Universal " FATHOM_TEXT(FATHOM_HAS_BASIS));
#endif
    return libraries;
}

}  // namespace fathom
