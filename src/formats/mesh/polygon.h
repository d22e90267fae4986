#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "fathom/vector.h"

namespace fathom {

/// Cuts a polygon into triangles and appends the numbers of their corners, 0 to points.size() - 1. Convex ones become a
/// fan; concave ones lose an ear at a time, as far as they are simple. Nearly flat polygons are projected along their
/// normal.
void triangulate(std::span<const Vec3f> points, std::vector<std::uint32_t>& corners);

}  // namespace fathom
