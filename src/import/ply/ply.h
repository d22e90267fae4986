#pragma once
#include <filesystem>
#include <string>

#include "import/common/importer.h"

namespace fathom {

/// Reads PLY, ASCII and binary of both byte orders: positions, normals, texture coordinates, colours; faces as polygons
/// or triangle strips; without faces, vertices as points (add_point_cloud). Other elements and properties are skipped.
SceneDescription read_ply(const std::filesystem::path& file, const std::string& bytes, LoadContext& context);

inline constexpr Importer ply_importer{
    [](const SourceFile& f) {
        return f.bytes.starts_with("ply\n") || f.bytes.starts_with("ply\r") || f.extension == ".ply";
    },
    [](const SourceFile& f, LoadContext& context) { return read_ply(f.path, f.bytes, context); }};

}  // namespace fathom
