#pragma once
#include <filesystem>
#include <string>

#include "import/common/load_context.h"

namespace fathom {

/// Reads glTF 2.0, as JSON or as GLB; which of them the bytes tell. What the format can say and Fathom can't show
/// (unknown extensions, lines, animation) is a warning; what the file calls required and isn't known is an Error.
///
/// bytes  the file's content
SceneDescription read_gltf(const std::filesystem::path& file, const std::string& bytes, const LoadOptions& options,
                           LoadContext& context);

}  // namespace fathom
