// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "fathom/description.h"

namespace fathom::mitsuba {

/// Triangulates the zero level set of a grid of signed distances in the unit cube, by trilinear interpolation at a
/// resolution finer than the grid. All texture coordinates are (0, 0). Throws Error.
///
/// bytes   content of a volume file (VOL, version 3) of one channel
/// smooth  whether normals are interpolated between cells (Hansson-Soderlund, Evans, Akenine-Moller, "Ray Tracing of
/// Signed Distance Function Grids", 2022); otherwise the mesh has no normals
Mesh sdf_mesh(const std::string& file, std::string_view bytes, bool smooth);

}  // namespace fathom::mitsuba
