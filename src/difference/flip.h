// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "difference/comparable.h"
#include "fathom/image_difference.h"

namespace fathom {

/// FLIP of display values as linear Rec.709 in [0, 1] (Andersson et al. 2020). The result has no exposures.
Flip flip_of_display(const Colors& image, const Colors& reference, int width, int height);

/// HDR-FLIP of radiance (Andersson et al. 2021): the largest FLIP over the exposures that the reference suggests.
/// Negative radiance counts as 0.
Flip flip_of_radiance(const Colors& image, const Colors& reference, int width, int height);

}  // namespace fathom
