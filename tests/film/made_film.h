#pragma once
#include "film/film_data.h"

namespace fathom::test {

/// An empty film of no scene, to be filled by hand.
inline Film made_film(const RenderSettings& settings)
{
    const Film::Data data(FilmKey{settings, std::string(32, '0')});
    Film::Sums sums;
    sums.width = data.width, sums.height = data.height, sums.words_per_pixel = data.layout.words;
    sums.words.assign(data.words.begin(), data.words.end());
    sums.key = data.key.text();
    return Film::from_sums(sums);
}

}  // namespace fathom::test
