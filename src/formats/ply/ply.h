#pragma once
#include <filesystem>
#include <string>

#include "formats/common/importer.h"
#include "formats/ply/ply_colors.h"

namespace fathom {

/// What a PLY file holds, as it is: without anything left out.
struct PlyData {
    Mesh mesh;                                ///< without faces: points
    std::vector<float> radii;                 ///< of vertices, or empty
    std::vector<Vec4f> face_colors;           ///< of triangles, or empty
    std::vector<std::uint32_t> curve_counts;  ///< how many vertices each curve has, where there are curves
    std::vector<std::uint32_t> quads;         ///< the first triangle of each face of four corners
    std::size_t bad_faces = 0;                ///< with fewer than three corners, which are not there
};
/// colors  what becomes colours of vertices or faces; of faces those of the same name are read in any case
PlyData read_ply_data(InputFile& input, const PlyAttribute& colors = {});

/// Reads PLY, ASCII and binary of both byte orders: positions, normals, texture coordinates, colours of vertices, or
/// else those of faces; faces as polygons or triangle strips; without faces, vertices as points, of their radius or one
/// that fits (add_point_cloud). Other elements and properties are skipped.
SceneDescription read_ply(const std::filesystem::path& file, InputFile& input, LoadContext& context);

inline constexpr Importer ply_importer{
    [](const SourceFile& f) {
        return f.head().starts_with("ply\n") || f.head().starts_with("ply\r") || f.extension == ".ply";
    },
    [](const SourceFile& f, LoadContext& context) { return read_ply(f.path, f.input, context); }, false, false, "PLY"};

}  // namespace fathom
