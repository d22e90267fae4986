#pragma once
#include "geometry/bvh/bvh.h"

namespace fathom {

/// The AlphaTest of all scenes: whether a hit counts on a shape whose material has an alpha.
///
/// Where alpha blends, a number decides that is hashed from the ray, the primitive and the instance: a share of alpha
/// of the rays is stopped, each layer decides for itself, and the answer for a ray is always the same. context: the
/// SceneTables.
bool alpha_passes(const void* context, const AlphaCandidate& candidate);

}  // namespace fathom
