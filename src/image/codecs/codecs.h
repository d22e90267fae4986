// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "image/picture.h"

/// One reader for each image format, and one writer for each format that Fathom writes.
///
/// Readers throw Error naming `name`; the caller has checked that the file begins with the format's signature. Writers
/// expect an image whose layers agree in size.
namespace fathom {

class OutputFile;

/// The bytes of an image file, its name for messages, and the memory in bytes that its reader may use.
struct EncodedImage {
    const std::string& name;
    const unsigned char* bytes;
    std::size_t size;
    std::uint64_t memory_limit;
    PictureSize* measured = nullptr;  ///< set if only the size is wanted: check_size() stores it here and throws
                                      ///< Measured
};

/// Thrown by check_size() to end a reader when only the size is wanted.
struct Measured {};

Image read_exr(const EncodedImage& file);
Picture read_png(const EncodedImage& file);
Picture read_jpeg(const EncodedImage& file);
ByteImage read_webp(const EncodedImage& file);
/// Whether the file's brand is AVIF; the whole family of ISO media files, such as HEIF and MP4, has the same signature.
bool is_avif(const EncodedImage& file);
/// Reads the first image of the file, with its rotation, mirroring and clean aperture applied.
Picture read_avif(const EncodedImage& file);
Image read_hdr(const EncodedImage& file);
/// Whether the file begins as a portable float map.
bool is_pfm(const EncodedImage& file);
/// Reads RGB (PF), gray (Pf) and RGBA (PF4).
Image read_pfm(const EncodedImage& file);
/// Reads the largest mip level of an image in Basis Universal encoding (ETC1S or UASTC).
ByteImage read_ktx2(const EncodedImage& file);
/// Reads BMP, TGA, GIF, PSD, PIC and PNM.
Image read_stb(const EncodedImage& file);

void write_exr(OutputFile& file, const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_png(const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_jpeg(const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_webp(const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_avif(const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_hdr(const Image& image);

/// Throws Error if the size is 0, or if its bytes exceed the available memory or the limit. Every reader calls it after
/// it has read the file's header.
void check_size(const EncodedImage& file, std::uint64_t width, std::uint64_t height, std::uint64_t bytes_per_pixel);

/// An image of one layer with channels Y, Y A, R G B or R G B A, by `channels`; values are 0.
Image make_image(int width, int height, int channels);

/// Indices of the layer's channels that are displayed as red, green, blue and alpha; alpha is -1 if there is none.
struct DisplayChannels {
    int r = 0, g = 0, b = 0, a = -1;
};
/// Selects R, G, B and A by name, otherwise the first three channels, otherwise the first channel as gray.
DisplayChannels display_channels(const Image::Layer& layer);

}  // namespace fathom
