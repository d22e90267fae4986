// SPDX-License-Identifier: Apache-2.0
#include "session/kernel_settings.h"

#include <algorithm>
#include <cmath>

namespace fathom {

KernelSettings kernel_settings(const RenderSettings& s, const FilmLayout& layout)
{
    KernelSettings k;
    k.width = s.width;
    k.height = s.height;
    k.seed = s.seed;
    k.max_depth = s.max_depth;
    k.roulette_depth = s.roulette_depth;
    k.light_sampling = s.light_sampling;
    k.light_selection = s.light_selection;
    k.measure = s.measure_stages;
    if (s.light_sampling)
        k.light_paths = std::uint32_t(std::min(std::ceil(s.light_paths * s.width * s.height), 0x1p31));
    k.clamp_indirect = s.clamp_indirect.value_or(0);
    k.filter = std::uint32_t(s.filter);
    if (s.filter_radius > 0) k.filter_stretch = float(s.filter_radius / filter_radii[k.filter]);
    k.aovs = layout;
    k.film_words = std::size_t(layout.words);
    k.background.given = s.background.has_value();
    if (s.background) k.background.radiance = {s.background->r, s.background->g, s.background->b};
    return k;
}

}  // namespace fathom
