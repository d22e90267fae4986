#include "image/avif_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <string>
#include <type_traits>

#include "fathom/error.h"

namespace fathom {

namespace {

/// That of the headers that this is built with: 0.11, or any 1.x.
constexpr const char* soname = AVIF_VERSION_MAJOR == 0 ? "libavif.so.15" : "libavif.so.16";

std::string last_reason()
{
    const char* const reason = dlerror();
    return reason ? reason : "unknown reason";
}

AvifLibrary open_library()
{
    void* const library = dlopen(soname, RTLD_NOW | RTLD_LOCAL);
    if (!library) throw Error("", "", fmt::format("AVIF needs {}, which can't be opened: {}", soname, last_reason()));
    AvifLibrary avif{};
    const auto take = [&](auto& function, const char* name) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
        if (!function) throw Error(soname, name, "there is no such function: this is not libavif");
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
