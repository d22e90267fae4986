#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fathom/image.h"

/// Pictures as their files hold them. read_image() makes floats of all; textures keep bytes as they are.
namespace fathom {

/// A picture of bytes, row by row from the top left, encoded as they are in the file.
struct ByteImage {
    int width = 0, height = 0;
    int channels = 0;                   ///< of the file: 1 grey, 2 grey and alpha, 3 colours, 4 colours and alpha
    std::vector<std::uint32_t> texels;  ///< red in the lowest byte, then green, blue and alpha, whatever the file has

    /// Alpha is whole until it is filled in.
    ByteImage(int width, int height, int channels);
    unsigned char* bytes() { return reinterpret_cast<unsigned char*>(texels.data()); }
};

using Picture = std::variant<ByteImage, Image>;

/// As read_image(), which says what is thrown.
Picture read_picture(const std::filesystem::path& file, std::uint64_t memory_limit);
Picture read_picture(const std::string& name, const void* bytes, std::size_t size, std::uint64_t memory_limit);

/// What the head of a picture's file says.
struct PictureSize {
    std::uint64_t width = 0, height = 0;
    std::uint64_t bytes_per_pixel = 0;  ///< while it is read: 4 where it is a ByteImage from the beginning

    double pixels() const { return double(width) * double(height); }
};
/// Without reading the picture; nothing where the file is none, or damaged.
std::optional<PictureSize> measure_picture(const std::filesystem::path& file);
std::optional<PictureSize> measure_picture(const std::string& name, const void* bytes, std::size_t size);

/// The channels of the file, each byte over 255. Throws Error, naming `name`, where there is not the memory.
Image to_image(const ByteImage& picture, const std::string& name, std::uint64_t memory_limit);

}  // namespace fathom
