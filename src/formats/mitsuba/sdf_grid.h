#pragma once
#include <string>
#include <string_view>

#include "fathom/description.h"

namespace fathom::mitsuba {

/// The surface where a grid of signed distances is 0, which lies in the unit cube: between the grid's numbers as what
/// is linear along each axis makes it, cut into pieces finer than its cells. Throws Error.
///
/// All of it has the texture coordinates 0, 0.
///
/// bytes   of a volume file (VOL, version 3) of one channel
/// smooth  normals between cells are mixed (Hansson-Soderlund, Evans, Akenine-Moller: Ray Tracing of Signed Distance
///         Function Grids, 2022), else there are none: those of the pieces
Mesh sdf_mesh(const std::string& file, std::string_view bytes, bool smooth);

}  // namespace fathom::mitsuba
