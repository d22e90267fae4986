// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "film/film_data.h"

namespace fathom::test {

/// An empty film without a scene.
inline Film make_test_film(const RenderSettings& settings)
{
    return Film(FilmKey{settings, std::string(32, '0')});
}

}  // namespace fathom::test
