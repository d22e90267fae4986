// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>

namespace fathom {

/// Decodes sRGB to a linear value (IEC 61966-2-1).
inline float linear_from_srgb(double c)
{
    return float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

}  // namespace fathom
