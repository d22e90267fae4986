// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "options/scene_options.h"

namespace fathom::cli {

/// Contents of a scene or model file, the features it uses, and what Fathom ignores. Throws Error if the file can't be
/// read; a scene that can be read but not rendered gets an entry that says so.
nlohmann::ordered_json describe_scene(const SceneOptions& options);
void print_scene_text(const nlohmann::ordered_json& info);

}  // namespace fathom::cli
