#pragma once
#include <cstdint>
#include <filesystem>
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

/// The channels of the file, each byte over 255. Throws Error, naming `name`, where there is not the memory.
Image to_image(const ByteImage& picture, const std::string& name, std::uint64_t memory_limit);

}  // namespace fathom
