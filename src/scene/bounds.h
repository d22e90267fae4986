#pragma once
#include "fathom/load.h"

namespace fathom {

/// Of a shape in its node's space, over all of its own motion.
Bounds shape_bounds(const SceneDescription& scene, const Shape& shape);

}  // namespace fathom
