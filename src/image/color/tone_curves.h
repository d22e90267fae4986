// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/image.h"
#include "fathom/vector.h"

namespace fathom {

/// Applies a tone map: exposed radiance, finite and non-negative, to linear Rec.709 in [0, 1] for the display.
Color tone_map(Tonemap tonemap, const Color& radiance);

/// Narkowicz's fit of the ACES curve: maps 0 to 0, 1 to 0.80 and infinity to 1 (K. Narkowicz, "ACES Filmic Tone Mapping
/// Curve", 2016).
float filmic_curve(float x);

}  // namespace fathom
