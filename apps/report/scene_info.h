#pragma once
#include <nlohmann/json_fwd.hpp>

#include "options/scene_options.h"

namespace fathom::cli {

/// What is in a scene or model file, what it uses, and what of it is left out. Throws Error if it can't be read; what
/// can be read but not rendered is told.
nlohmann::ordered_json describe_scene(const SceneOptions& options);
void print_scene_text(const nlohmann::ordered_json& info);

}  // namespace fathom::cli
