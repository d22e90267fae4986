#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "image/picture.h"

/// One reader per format, and one writer for those that Fathom writes. Readers throw Error naming `name`; what they are
/// given begins as a file of their format does. Writers get a picture whose sizes agree.
namespace fathom {

class OutputFile;

/// The bytes of a picture file, what to call it in messages, and how much memory its reader may take.
struct EncodedImage {
    const std::string& name;
    const unsigned char* bytes;
    std::size_t size;
    std::uint64_t memory_limit;
    PictureSize* measured = nullptr;  ///< only the size is wanted: check_size() puts it here, and ends reading
};

/// What check_size() throws where only the size is wanted.
struct Measured {};

Image read_exr(const EncodedImage& file);
Picture read_png(const EncodedImage& file);
Picture read_jpeg(const EncodedImage& file);
ByteImage read_webp(const EncodedImage& file);
/// Whether the file says that it is AVIF: its first bytes are those of a whole family of formats.
bool is_avif(const EncodedImage& file);
/// The first picture of the file, turned and cut as it says.
Picture read_avif(const EncodedImage& file);
Image read_hdr(const EncodedImage& file);
/// Whether the file says that it is a portable float map.
bool is_pfm(const EncodedImage& file);
/// Color, gray, and color with alpha (PF4).
Image read_pfm(const EncodedImage& file);
/// A picture packed by Basis Universal, as ETC1S or UASTC: its largest level.
ByteImage read_ktx2(const EncodedImage& file);
/// BMP, TGA, GIF, PSD, PIC, PNM.
Image read_stb(const EncodedImage& file);

void write_exr(OutputFile& file, const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_png(const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_jpeg(const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_webp(const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_avif(const Image& image, const WriteOptions& options);
std::vector<unsigned char> encode_hdr(const Image& image);

/// Throws Error if the size is none, or if `bytes_per_pixel` times it is more than there is or the limit. Every reader
/// calls it when it has read the head of the file.
void check_size(const EncodedImage& file, std::uint64_t width, std::uint64_t height, std::uint64_t bytes_per_pixel);

/// An image of one layer with Y, Y A, R G B or R G B A, by `channels`, values not yet filled in.
Image make_image(int width, int height, int channels);

/// Which of the layer's channels to show as red, green, blue and alpha; alpha is -1 if there is none.
struct DisplayChannels {
    int r = 0, g = 0, b = 0, a = -1;
};
DisplayChannels display_channels(const Image::Layer& layer);

}  // namespace fathom
