#pragma once
#include "fathom/image.h"
#include "fathom/vector.h"

namespace fathom {

/// What the display shows, 0 to 1 and linear Rec.709, of exposed radiance that is finite and not negative.
Color tone_map(Tonemap tonemap, const Color& radiance);

/// Narkowicz's fit of the ACES curve: 0 to 0, 1 to 0.80, infinity to 1.
/// K. Narkowicz: ACES Filmic Tone Mapping Curve, 2016.
float filmic_curve(float x);

}  // namespace fathom
