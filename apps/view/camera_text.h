// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/description.h"

namespace fathom::view {

/// The camera as a line for a scene file, `"camera": {...}` (docs/scene-format.md).
std::string camera_text(const Camera& camera);

}  // namespace fathom::view
