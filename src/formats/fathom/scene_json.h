#pragma once
#include <string>
#include <vector>

#include "formats/fathom/save_files.h"
#include "formats/json/json_text.h"

namespace fathom {

/// The scene as its file says it; what stands in files beside it is added to `files`.
Json scene_json(const SceneDescription& scene, const std::string& file, SaveFiles& files, Warnings& warnings);

}  // namespace fathom
