// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "compile/compiler.h"

namespace fathom {

/// Adds curves to the tables as cubic Bezier segments or lines. Chooses the number of straight pieces so that no piece
/// deviates from the curve by more than a fiftieth of its radius. Returns the number of segments.
///
/// factor: scale of lengths by the transform. moves: whether control points move during the shutter interval; then they
/// are added for each of vertex_times.
std::size_t add_curves(SceneTables& tables, const Curves& curves, const Transform& transform, double factor,
                       bool moves);

}  // namespace fathom
