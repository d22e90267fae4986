#pragma once
#include <string>

#include "fathom/description.h"

namespace fathom::view {

/// `"camera": {...}`, a line to be put into a scene file (docs/scene-format.md).
std::string camera_text(const Camera& camera);

}  // namespace fathom::view
