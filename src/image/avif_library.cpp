#include "image/avif_library.h"

#include <fmt/format.h>

#include <string>

#include "fathom/error.h"
#include "scene/shared_library.h"

namespace fathom {

namespace {

/// That of the headers that this is built with: 0.11, or any 1.x.
constexpr const char* soname = AVIF_VERSION_MAJOR == 0 ? "libavif.so.15" : "libavif.so.16";

AvifLibrary open_library()
{
    void* const library = dlopen(soname, RTLD_NOW | RTLD_LOCAL);
    if (!library)
        throw Error("", "", fmt::format("AVIF needs {}, which can't be opened: {}", soname, shared_library_trouble()));
    AvifLibrary avif{};
    const auto take = [&](auto& function, const char* name) {
        take_function(library, soname, "libavif", name, function);
    };
    take(avif.avifCropRectConvertCleanApertureBox, "avifCropRectConvertCleanApertureBox");
    take(avif.avifDecoderCreate, "avifDecoderCreate");
    take(avif.avifDecoderDestroy, "avifDecoderDestroy");
    take(avif.avifDecoderNextImage, "avifDecoderNextImage");
    take(avif.avifDecoderParse, "avifDecoderParse");
    take(avif.avifDecoderSetIOMemory, "avifDecoderSetIOMemory");
    take(avif.avifEncoderCreate, "avifEncoderCreate");
    take(avif.avifEncoderDestroy, "avifEncoderDestroy");
    take(avif.avifEncoderWrite, "avifEncoderWrite");
    take(avif.avifImageCreate, "avifImageCreate");
    take(avif.avifImageDestroy, "avifImageDestroy");
    take(avif.avifImageRGBToYUV, "avifImageRGBToYUV");
    take(avif.avifImageYUVToRGB, "avifImageYUVToRGB");
    take(avif.avifPeekCompatibleFileType, "avifPeekCompatibleFileType");
    take(avif.avifRGBImageSetDefaults, "avifRGBImageSetDefaults");
    take(avif.avifRWDataFree, "avifRWDataFree");
    take(avif.avifResultToString, "avifResultToString");
    return avif;
}

}  // namespace

const AvifLibrary& avif_library()
{
    static const AvifLibrary avif = open_library();
    return avif;
}

}  // namespace fathom
