// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "fathom/description.h"
#include "fathom/load.h"

namespace fathom {

/// The bytes of a GLB file (glTF 2.0). The scene must have passed check_scene.
///
/// file  name of the file, for warnings and errors
std::string glb_bytes(const SceneDescription& scene, const std::string& file, Warnings& warnings);

}  // namespace fathom
