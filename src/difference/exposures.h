// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "difference/comparable.h"

namespace fathom {

/// Exposures in stops at which HDR-FLIP compares: `count` of them from `first` to `last`, equally spaced.
struct Exposures {
    double first = 0, last = 0;
    int count = 2;

    double exposure(int index) const { return first + (last - first) * index / (count - 1); }
};

/// The exposures of a reference: from those that show its brightest pixel below white, to those that show its median as
/// bright (Andersson et al. 2021, section 3.2).
Exposures exposures_for(const Colors& reference);

/// Exposed colors in [0, 1] by the ACES curve of K. Narkowicz 2016 with the exposure of the paper.
Colors tone_mapped(const Colors& radiance, double exposure_ev);

}  // namespace fathom
