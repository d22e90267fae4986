#pragma once
#include <filesystem>
#include <string_view>

#include "import/common/load_context.h"

namespace fathom {

/// Reads Fathom's own scene file: docs/scene-format.md says what may stand in it.
///
/// text  the file's content
SceneDescription read_fathom_json(const std::filesystem::path& file, std::string_view text, LoadContext& context);

}  // namespace fathom
