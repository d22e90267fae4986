// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/api.h"
#include "fathom/description.h"

namespace fathom {

/// Returns digests of a scene's environment, cameras, lights, materials and textures as text: a line for each object,
/// with its name and a hash of each parameter.
///
/// A film file stores the text; scene_digest_difference() then tells which objects of another scene differ. The text
/// ends after about one million characters. Geometry is not included.
FATHOM_API std::string scene_digest(const SceneDescription& scene);

/// Compares two results of scene_digest() and returns the differences as a phrase for messages, such as
/// `material 'wall': color; light 'lamp' is new`. It names up to four objects. Returns an empty string if the texts are
/// equal.
FATHOM_API std::string scene_digest_difference(const std::string& before, const std::string& now);

}  // namespace fathom
