#pragma once
#include <filesystem>
#include <string>

#include "import/common/load_context.h"

namespace fathom {

/// Reads STL, ASCII and binary. Corners at the same place become one vertex; the normals in the file are not used, as
/// the order of the corners says the same.
SceneDescription read_stl(const std::filesystem::path& file, const std::string& bytes, LoadContext& context);

}  // namespace fathom
