// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "film/film_data.h"

namespace fathom {

/// One number of a film's pixel and the bytes of it that a file stores: bytes below are 0, bytes above repeat the sign.
struct PackedNumber {
    int word;   ///< first word within the film's pixel
    int words;  ///< 32-bit words, lowest first: 3 for a signed sum, 4 for a sum of squares, 1 for an id
    int first = 0, bytes = 0;
};

/// Packing of the numbers of a film's pixels: one after another, lowest byte first, each with as many bytes as its
/// largest value in the image needs. Most of a sum's 12 bytes, and of a square's 16, are the same in every pixel.
class Packing {
public:
    /// The tightest packing that holds all numbers of the film.
    explicit Packing(const Film::Data& film);
    /// Parses the packing of a file, as text() wrote it. Throws Error if it is not valid for a film of this layout.
    Packing(const FilmLayout& layout, const std::string& text);

    /// The packing as text, for an attribute of the file.
    std::string text() const;
    /// 32-bit words of a packed pixel.
    int words() const { return words_; }
    /// Distance between packed pixels in bytes, including slack that pack() and unpack() access.
    std::size_t stride() const { return std::size_t(words_) * 4 + slack; }
    /// Bytes after the last pixel that pack() may read.
    static constexpr std::size_t slack = 16;
    /// Packs contiguous pixels. Blocks of about 64 are fast: each number is packed for all of them while they are in
    /// the cache.
    void pack(const std::uint32_t* pixels, std::size_t count, unsigned char* packed) const;
    /// Inverse of pack(); sets all words of the pixels.
    void unpack(const unsigned char* packed, std::size_t count, std::uint32_t* pixels) const;

private:
    void count_words();

    std::vector<PackedNumber> numbers_;
    std::size_t pixel_words_ = 0;  ///< number of words of a film pixel
    int words_ = 0;
};

}  // namespace fathom
