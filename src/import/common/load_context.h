#pragma once
#include <filesystem>
#include <vector>

#include "fathom/load.h"

namespace fathom {

/// What is the same for a scene file and the model files that it refers to.
struct LoadContext {
    Warnings& warnings;
    std::vector<std::filesystem::path> open_files;  ///< being read now, the first asked for them all: finds cycles
};

/// load_scene for the scene itself and for the models in it.
SceneDescription load_file(const std::filesystem::path& file, const LoadOptions& options, LoadContext& context);

}  // namespace fathom
