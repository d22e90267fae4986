// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "film/film_words.h"

namespace fathom::test {

/// The sums of all pixels.
inline std::vector<std::uint32_t> words_of(const Film& film)
{
    const std::size_t pixels = std::size_t(film.width()) * std::size_t(film.height());
    const std::uint32_t* words = film_words(film);
    return {words, words + pixels * std::size_t(words_per_pixel(film))};
}

inline Film copy_of(const Film& film)
{
    Film copy(film.key());
    copy.merge(film);
    return copy;
}

}  // namespace fathom::test
