#pragma once
#include <cstdint>
#include <vector>

#include "fathom/description.h"

namespace fathom::pbrt {

/// Loop's subdivision (C. Loop: Smooth Subdivision Surfaces Based on Triangles, 1987), at last moved to the limit.
Mesh loop_subdivided(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices, int levels);

}  // namespace fathom::pbrt
