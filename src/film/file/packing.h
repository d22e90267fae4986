#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "film/film_data.h"

namespace fathom {

/// One number of a film's pixel, and which of its bytes a file keeps: those below are 0, those above are its sign.
struct PackedNumber {
    int word;   ///< where it begins in the film's pixel
    int words;  ///< of 32 bits, lowest first: 3 of a sum, which has a sign, 4 of squares, 1 of an id
    int first = 0, bytes = 0;
};

/// How the numbers of a film's pixels are packed: one behind the other, lowest byte first, each with the bytes that the
/// largest of the picture needs. Most of a sum's 12 bytes, and of a square's 16, are the same in every pixel.
class Packing {
public:
    /// The tightest that holds all that is in the film.
    explicit Packing(const Film::Data& film);
    /// That of a file, as text() wrote it. Throws Error if it can't be that of such a film.
    Packing(const FilmLayout& layout, const std::string& text);

    std::string text() const;
    /// 32-bit words that a packed pixel takes.
    int words() const { return words_; }
    /// From one packed pixel to the next, in bytes: behind each there is room that is written to and read as well.
    std::size_t stride() const { return std::size_t(words_) * 4 + slack; }
    /// Bytes behind the pixels that pack reads.
    static constexpr std::size_t slack = 16;
    /// Packs pixels that lie behind each other, some 64 of them: a number of all at a time, from the cache.
    void pack(const std::uint32_t* pixels, std::size_t count, unsigned char* packed) const;
    /// The inverse, which sets all words of the pixels.
    void unpack(const unsigned char* packed, std::size_t count, std::uint32_t* pixels) const;

private:
    void count_words();

    std::vector<PackedNumber> numbers_;
    std::size_t pixel_words_ = 0;  ///< of the film
    int words_ = 0;
};

}  // namespace fathom
