#pragma once
#include <span>
#include <vector>

#include "fathom/load.h"

namespace fathom {

/// Of a shape in its node's space, over all of its own motion.
Bounds shape_bounds(const SceneDescription& scene, const Shape& shape);

/// The largest dot(p, direction) over all points p of the scene's geometry in world space, for each direction; empty if
/// there is no geometry. As exact as world_bounds.
std::vector<double> world_reach(const SceneDescription& scene, std::span<const Vec3d> directions);

}  // namespace fathom
