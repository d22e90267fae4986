// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "formats/fathom/save_files.h"
#include "formats/json/json_text.h"

namespace fathom {

/// The scene in Fathom's scene format; data for separate files is added to `files`.
Json scene_json(const SceneDescription& scene, const std::string& file, SaveFiles& files, Warnings& warnings);

}  // namespace fathom
