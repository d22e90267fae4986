// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fathom/image.h"

/// Images in the precision of their files. read_image() converts all of them to float; textures keep bytes.
namespace fathom {

/// An image of bytes, in rows from the top left, encoded as in the file.
struct ByteImage {
    int width = 0, height = 0;
    int channels = 0;                   ///< channels of the file: 1 gray, 2 gray and alpha, 3 RGB, 4 RGBA
    std::vector<std::uint32_t> texels;  ///< red in the lowest byte, then green, blue and alpha, for any number of
                                        ///< channels

    /// Allocates an opaque image.
    ByteImage(int width, int height, int channels);
    unsigned char* bytes() { return reinterpret_cast<unsigned char*>(texels.data()); }
};

using Picture = std::variant<ByteImage, Image>;

/// Reads an image in the precision of its file. Formats and errors are those of read_image().
Picture read_picture(const std::filesystem::path& file, std::uint64_t memory_limit);
Picture read_picture(const std::string& name, const void* bytes, std::size_t size, std::uint64_t memory_limit);

/// Size of an image, from the header of its file.
struct PictureSize {
    std::uint64_t width = 0, height = 0;
    std::uint64_t bytes_per_pixel =
        0;  ///< memory per pixel while reading; 4 if the reader produces a ByteImage directly

    double pixels() const { return double(width) * double(height); }
};
/// Reads the size without decoding the image; nothing if the file is not an image or is damaged.
std::optional<PictureSize> measure_picture(const std::filesystem::path& file);
std::optional<PictureSize> measure_picture(const std::string& name, const void* bytes, std::size_t size);

/// Converts bytes to floats in [0, 1]; channels are those of the file. Throws Error, naming `name`, if memory is short.
Image to_image(const ByteImage& picture, const std::string& name, std::uint64_t memory_limit);

}  // namespace fathom
