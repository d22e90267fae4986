#pragma once
#include <array>
#include <cstddef>

#include "base/large_memory.h"

namespace fathom {

/// A linear picture of red, green, blue and alpha.
struct CubeFace {
    int width = 0, height = 0;
    LargeVector<float> texels;
};

/// The width of the equirectangular picture that keeps what these faces show.
int equirectangular_width(const std::array<CubeFace, 6>& faces);

/// That picture, half as high as wide, of red, green, blue and 1. Faces are in the order and turned as OpenGL has
/// them; where they have alpha their colours are divided by it, which is RGBD.
LargeVector<float> equirectangular(const std::array<CubeFace, 6>& faces);

}  // namespace fathom
