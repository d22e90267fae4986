#pragma once
#include "integrate/scene.h"

namespace fathom::inline FATHOM_LANES {

/// Lets the tree try shadow rays like those of pictures: see Bvh::expect. They go from places on triangles to where
/// lights are sampled.
void try_shadow_rays(LaneScene& scene);

}  // namespace fathom::inline FATHOM_LANES
