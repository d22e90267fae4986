// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vector>

#include "fathom/ground_truth.h"

namespace fathom::cli {

/// Writes the meshes of objects as BOP's models: obj_000001.ply and so on in millimeters, and models_info.json. Objects
/// without meshes, such as spheres, get no file.
void write_bop_models(const std::filesystem::path& folder, const SceneDescription& scene,
                      const std::vector<SceneObject>& objects);

}  // namespace fathom::cli
