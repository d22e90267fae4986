#pragma once
#include <string>

#include "fathom/api.h"
#include "fathom/description.h"

namespace fathom {

/// Digests of a scene's materials and textures, value by value, and of its cameras, lights and environment, by name:
/// kept with a render, they tell later in what another scene differs. A line a part; of the largest scenes the first
/// some thousand.
FATHOM_API std::string scene_digest(const SceneDescription& scene);

/// In what two such texts differ: "material 'wall': color; light 'lamp' is new". Empty where they don't.
FATHOM_API std::string scene_digest_difference(const std::string& before, const std::string& now);

}  // namespace fathom
