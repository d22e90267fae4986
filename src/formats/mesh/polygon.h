// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "fathom/vector.h"

namespace fathom {

/// Triangulates a polygon and appends the corners' indices, 0 to points.size() - 1. Convex polygons become a fan.
/// Concave simple polygons are cut by ear clipping. Nearly flat polygons are projected along their normal.
void triangulate(std::span<const Vec3f> points, std::vector<std::uint32_t>& corners);

}  // namespace fathom
