#pragma once
#include "image/projections/cube_map.h"

namespace fathom {

/// The equirectangular picture, twice as wide as high, of red, green, blue and 1, of a square picture in which all
/// parts of the sphere have their share (P. Clarberg: Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD, 2008):
/// +z is in its middle, +x to the right, +y downwards, and -z in its corners.
LargeVector<float> equirectangular_from_equal_area(const CubeFace& square);
inline int equirectangular_width(const CubeFace& square)
{
    return 2 * square.width;
}

}  // namespace fathom
