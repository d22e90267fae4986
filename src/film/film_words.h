// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Sums of films as 32-bit words, for processes that exchange films in pieces. The program calls these functions when
/// it renders with MPI; the header is not installed.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fathom/film.h"

namespace fathom {

/// Returns the number of 32-bit words of a pixel's sums.
FATHOM_API int words_per_pixel(const Film& film);
/// Returns the sums: words_per_pixel() words for each pixel, row by row from the top left. docs/film-files.md describes
/// the numbers of a pixel.
FATHOM_API const std::uint32_t* film_words(const Film& film);
/// Adds the sums of `pixels` pixels in `from` to those in `to`, both laid out as film_words(). The film supplies the
/// layout only; its own sums don't change.
FATHOM_API void add_words(const Film& film, const std::uint32_t* from, std::uint32_t* to, std::size_t pixels);

/// Begins to merge a film of another process, whose sums follow in pieces through merge_words(). The film must not be
/// used for anything else until the sums of all pixels were added.
///
/// film            The film that receives the samples.
/// key             Key of the other film.
/// samples         Its ranges of samples, which count as present in this film from now on.
/// invalid         Its number of invalid samples.
/// invalid_sample  Its Film::invalid_sample().
///
/// Throws Error, without changing the film, if the keys differ or a sample is in both films.
FATHOM_API void begin_merge(Film& film, const FilmKey& key, const std::vector<SampleRange>& samples,
                            std::uint64_t invalid, const std::optional<Film::SampleLocation>& invalid_sample);
/// Adds the sums of consecutive pixels of the film named by begin_merge(). Pieces may arrive in any order.
///
/// film         The film that receives the sums.
/// first_pixel  Index of the first pixel, y * width + x.
/// words        pixels * words_per_pixel() words, laid out as film_words().
/// pixels       Number of pixels.
FATHOM_API void merge_words(Film& film, std::size_t first_pixel, const std::uint32_t* words, std::size_t pixels);

}  // namespace fathom
