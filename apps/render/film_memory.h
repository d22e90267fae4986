// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/memory.h"
#include "fathom/render.h"
#include "options/image_options.h"

namespace fathom::cli {

/// Use of a film, beside its settings.
struct FilmUse {
    bool has_checkpoint = false;  ///< a copy is written while rendering
    bool is_mergeable = false;    ///< EXR gets a copy of the sums
    int extra_channels = 0;       ///< channels of the image that no sum of the film's settings stands for
};

/// Memory that a film, its copies and its images take at most. Memory for optional passes is not counted, since it is
/// only taken where it is free.
std::vector<MemoryEstimate> film_memory(const RenderSettings& settings, const FilmUse& use, const ImageOptions& images);

}  // namespace fathom::cli
