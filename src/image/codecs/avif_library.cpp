// SPDX-License-Identifier: Apache-2.0
#include "image/codecs/avif_library.h"

#include <fmt/format.h>

#include <string>

#include "base/dynamic_library.h"
#include "fathom/error.h"

namespace fathom {

namespace {

/// The soname that belongs to the headers of this build: version 0.11, or any 1.x.
constexpr const char* soname = AVIF_VERSION_MAJOR == 0 ? "libavif.so.15" : "libavif.so.16";

AvifLibrary open_library()
{
    void* const library = dlopen(soname, RTLD_NOW | RTLD_LOCAL);
    if (!library)
        throw Error("", "", fmt::format("AVIF needs {}, which can't be opened: {}", soname, dynamic_library_error()));
    AvifLibrary avif{};
    const auto load_symbol = [&](auto& function, const char* name) {
        load_function(library, soname, "libavif", name, function);
    };
    load_symbol(avif.avifCropRectConvertCleanApertureBox, "avifCropRectConvertCleanApertureBox");
    load_symbol(avif.avifDecoderCreate, "avifDecoderCreate");
    load_symbol(avif.avifDecoderDestroy, "avifDecoderDestroy");
    load_symbol(avif.avifDecoderNextImage, "avifDecoderNextImage");
    load_symbol(avif.avifDecoderParse, "avifDecoderParse");
    load_symbol(avif.avifDecoderSetIOMemory, "avifDecoderSetIOMemory");
    load_symbol(avif.avifEncoderCreate, "avifEncoderCreate");
    load_symbol(avif.avifEncoderDestroy, "avifEncoderDestroy");
    load_symbol(avif.avifEncoderWrite, "avifEncoderWrite");
    load_symbol(avif.avifImageCreate, "avifImageCreate");
    load_symbol(avif.avifImageDestroy, "avifImageDestroy");
    load_symbol(avif.avifImageRGBToYUV, "avifImageRGBToYUV");
    load_symbol(avif.avifImageYUVToRGB, "avifImageYUVToRGB");
    load_symbol(avif.avifPeekCompatibleFileType, "avifPeekCompatibleFileType");
    load_symbol(avif.avifRGBImageSetDefaults, "avifRGBImageSetDefaults");
    load_symbol(avif.avifRWDataFree, "avifRWDataFree");
    load_symbol(avif.avifResultToString, "avifResultToString");
    return avif;
}

}  // namespace

const AvifLibrary& avif_library()
{
    static const AvifLibrary avif = open_library();
    return avif;
}

}  // namespace fathom
