// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "fathom/description.h"

namespace fathom::pbrt {

/// Subdivides a mesh `levels` times and moves its vertices to the limit surface (C. Loop, "Smooth Subdivision Surfaces
/// Based on Triangles", 1987).
Mesh loop_subdivided(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices, int levels);

}  // namespace fathom::pbrt
