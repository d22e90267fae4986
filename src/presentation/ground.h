#pragma once
#include "fathom/first_look.h"

namespace fathom {

/// Whether a camera sees a model from outside, and the ground below it from above.
bool ground_fits(const Bounds& model, const Camera& camera);

/// Adds the ground below `model`.
///
/// studio  whether a studio lights the scene: of other light it is not known what a floor makes of it
void add_ground(SceneDescription& scene, const Ground& ground, const Bounds& model, bool studio);

}  // namespace fathom
