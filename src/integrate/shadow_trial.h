// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/lane_scene.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Traces trial shadow rays, from surfaces to sampled lights, and passes them to Bvh::expect, which orders the BVH for
/// the shadow rays of rendering.
void order_by_trial_shadow_rays(LaneScene& scene);

}  // namespace FATHOM_LANES
}  // namespace fathom
