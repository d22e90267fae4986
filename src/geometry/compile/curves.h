#pragma once
#include <vector>

#include "compile/compiler.h"

namespace fathom {

/// Adds the segments of curves to the tables, as cubic Bezier segments or lines, and says how finely each is cut: so
/// that no piece strays from the curve by more than a fiftieth of its radius. Returns how many segments that are.
///
/// factor  by which the transform scales lengths
/// moves   whether control points do while the shutter is open: then there are those for each of vertex_times
std::size_t add_curves(SceneTables& tables, const Curves& curves, const Transform& transform, double factor,
                       bool moves);

}  // namespace fathom
