// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/lighting.h"

namespace fathom {

/// Whether a camera is outside a model's bounds and above the ground below it.
bool ground_fits(const Bounds& model, const Camera& camera);

/// Adds the ground below `model`, with its shape and material.
///
/// studio  whether the studio lights the scene; only then can the floor's color match the backdrop
void add_ground(SceneDescription& scene, const Ground& ground, const Bounds& model, bool studio);

}  // namespace fathom
