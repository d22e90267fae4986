#pragma once
#include <filesystem>
#include <string>

#include "import/common/load_context.h"

namespace fathom {

/// Reads PLY, ASCII and binary of both byte orders: positions, normals, texture coordinates, colours; faces as polygons
/// or triangle strips; without faces, vertices as points (add_point_cloud). Other elements and properties are skipped.
SceneDescription read_ply(const std::filesystem::path& file, const std::string& bytes, LoadContext& context);

}  // namespace fathom
