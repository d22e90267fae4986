// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "geometry/bvh/bvh.h"

namespace fathom {

/// The AlphaTest of all scenes: whether a hit on an alpha-tested shape is opaque. context: the SceneTables.
///
/// Alpha blending is stochastic: a number hashed from the ray, the primitive and the instance is compared with alpha.
/// Each layer decides independently, and the decision for a given ray never changes.
bool alpha_passes(const void* context, const AlphaCandidate& candidate);

/// The AlphaTest of ground truth, which is not stochastic: a hit is opaque if its opacity is 0.5 or more. context: the
/// SceneTables.
bool is_half_opaque(const void* context, const AlphaCandidate& candidate);

}  // namespace fathom
