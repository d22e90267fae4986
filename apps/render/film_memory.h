#pragma once
#include <vector>

#include "fathom/memory.h"
#include "fathom/render.h"
#include "options/image_options.h"

namespace fathom::cli {

/// How a film is used, beside its settings.
struct FilmUse {
    bool is_kept = false;       ///< written as a film while rendering: a copy of it is taken
    bool is_mergeable = false;  ///< the same for the picture at the end
    int extra_channels = 0;     ///< of the picture: what no sum of the film's settings stands for
};

/// What a film, its copies and its pictures take at the most. More, for passes that can be dropped, is only taken where
/// there is more.
std::vector<MemoryEstimate> film_needs(const RenderSettings& settings, const FilmUse& use,
                                       const PictureOptions& pictures);

}  // namespace fathom::cli
