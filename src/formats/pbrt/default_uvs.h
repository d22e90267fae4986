// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom::pbrt {

/// Sets pbrt's default texture coordinates: (0, 0), (1, 0) and (1, 1) at the corners of each triangle, and those of the
/// unit square for quadrilaterals. Triangles share no vertices afterwards.
///
/// quads  index of the first of the two triangles of each quadrilateral, ascending
void add_default_uvs(Mesh& mesh, const std::vector<std::uint32_t>& quads);

}  // namespace fathom::pbrt
