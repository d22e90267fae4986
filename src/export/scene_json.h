#pragma once
#include <string>
#include <vector>

#include "export/json_text.h"
#include "export/save_files.h"

namespace fathom {

/// The scene as its file says it; what stands in files beside it is added to `files`.
Json scene_json(const SceneDescription& scene, const std::string& file, SaveFiles& files, Warnings& warnings);

}  // namespace fathom
