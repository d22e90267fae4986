// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <avif/avif.h>

namespace fathom {

/// Functions of libavif, which is loaded when the first AVIF image is read or written: linking it with all its codecs
/// would slow down every start of the program by about 4 ms.
struct AvifLibrary {
    decltype(::avifCropRectConvertCleanApertureBox)* avifCropRectConvertCleanApertureBox;
    decltype(::avifDecoderCreate)* avifDecoderCreate;
    decltype(::avifDecoderDestroy)* avifDecoderDestroy;
    decltype(::avifDecoderNextImage)* avifDecoderNextImage;
    decltype(::avifDecoderParse)* avifDecoderParse;
    decltype(::avifDecoderSetIOMemory)* avifDecoderSetIOMemory;
    decltype(::avifEncoderCreate)* avifEncoderCreate;
    decltype(::avifEncoderDestroy)* avifEncoderDestroy;
    decltype(::avifEncoderWrite)* avifEncoderWrite;
    decltype(::avifImageCreate)* avifImageCreate;
    decltype(::avifImageDestroy)* avifImageDestroy;
    decltype(::avifImageRGBToYUV)* avifImageRGBToYUV;
    decltype(::avifImageYUVToRGB)* avifImageYUVToRGB;
    decltype(::avifPeekCompatibleFileType)* avifPeekCompatibleFileType;
    decltype(::avifRGBImageSetDefaults)* avifRGBImageSetDefaults;
    decltype(::avifRWDataFree)* avifRWDataFree;
    decltype(::avifResultToString)* avifResultToString;
};

/// Loads libavif on first use and keeps it. Throws Error if it is missing.
const AvifLibrary& avif_library();

}  // namespace fathom
