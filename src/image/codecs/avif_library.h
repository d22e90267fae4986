#pragma once
#include <avif/avif.h>

namespace fathom {

/// The functions of libavif. It is opened when a picture asks for it: with all its coders, merely linking it would make
/// every start of the program slower by some 4 ms.
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

/// Opened once, and kept. Throws Error where it isn't there.
const AvifLibrary& avif_library();

}  // namespace fathom
