// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vector>

#include "fathom/load.h"

namespace fathom {

/// Bounds of a shape in its node's space, over all of its motion. Displacement is bounded by HeightRange.
Bounds shape_bounds(const SceneDescription& scene, const Shape& shape);

/// Support function of the scene: the largest dot(p, direction) over all points p of its geometry in world space, for
/// each direction. Empty if there is no geometry. The same approximations apply as in world_bounds.
std::vector<double> world_support(const SceneDescription& scene, std::span<const Vec3d> directions);

}  // namespace fathom
