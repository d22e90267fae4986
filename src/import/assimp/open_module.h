#pragma once
#include <filesystem>

#include "import/common/load_context.h"

namespace fathom {

/// Reads FBX, Collada, 3DS and whatever else Assimp knows, through the module beside this library. Throws Error if the
/// module isn't there or can't read the file.
SceneDescription read_with_assimp(const std::filesystem::path& file, const LoadOptions& options, LoadContext& context);

}  // namespace fathom
