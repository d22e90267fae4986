// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>

#include "base/large_memory.h"

namespace fathom {

/// A linear RGBA image: a face of a cube map, or a whole map in one square.
struct CubeFace {
    int width = 0, height = 0;
    LargeVector<float> texels;
};

/// Width of the equirectangular image that keeps the resolution of these faces.
int equirectangular_width(const std::array<CubeFace, 6>& faces);

/// Resamples a cube map to an equirectangular image, half as high as wide, of R, G, B and 1.
///
/// Faces have OpenGL's order and orientation. Colors of faces with alpha are divided by it (RGBD encoding).
LargeVector<float> equirectangular(const std::array<CubeFace, 6>& faces);

}  // namespace fathom
