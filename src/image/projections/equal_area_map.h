// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "image/projections/cube_map.h"

namespace fathom {

/// Resamples an equal-area map to an equirectangular image, twice as wide as high, of R, G, B and 1.
///
/// The square maps the sphere with constant area density (P. Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere
/// using SIMD", 2008): +z is at its center, +x to the right, +y downward, and -z in its corners.
LargeVector<float> equirectangular_from_equal_area(const CubeFace& square);
/// Width of the equirectangular image that keeps the resolution of an equal-area map.
inline int equirectangular_width(const CubeFace& square)
{
    return 2 * square.width;
}

}  // namespace fathom
