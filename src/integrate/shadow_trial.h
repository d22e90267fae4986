#pragma once
#include "kernel/lane_scene.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Lets the tree try shadow rays like those of pictures: see Bvh::expect. They go from places on triangles to where
/// lights are sampled.
void try_shadow_rays(LaneScene& scene);

}  // namespace FATHOM_LANES
}  // namespace fathom
