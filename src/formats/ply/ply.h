// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "formats/common/importer.h"
#include "formats/ply/ply_colors.h"

namespace fathom {

/// The complete contents of a PLY file.
struct PlyData {
    Mesh mesh;                                ///< a point cloud if it has no faces
    std::vector<float> radii;                 ///< one for each vertex, or empty
    std::vector<Vec4f> face_colors;           ///< one for each triangle, or empty
    std::vector<std::uint32_t> curve_counts;  ///< number of vertices of each curve, if the file has curves
    std::vector<std::uint32_t> quads;         ///< index of the first triangle of each quadrilateral
    std::size_t bad_faces = 0;                ///< number of faces with fewer than three corners, which are dropped
};
/// Reads a PLY file. Throws Error.
///
/// colors  attribute to read as the color of vertices or faces; if vertices are selected, face colors of the same name
/// are read too
PlyData read_ply_data(InputFile& input, const PlyAttribute& colors = {});

/// Reads PLY in ASCII and in binary of both byte orders.
/// - Vertices have positions, normals, texture coordinates and colors; without vertex colors, face colors are read.
/// - Faces are polygons or triangle strips.
/// - Without faces, vertices are points with their radius or one by fitting_points().
/// - Other elements and properties are skipped.
SceneDescription read_ply(const std::filesystem::path& file, InputFile& input, LoadContext& context);

inline constexpr Importer ply_importer{
    [](const SourceFile& f) {
        return f.head().starts_with("ply\n") || f.head().starts_with("ply\r") || f.extension == ".ply";
    },
    [](const SourceFile& f, LoadContext& context) { return read_ply(f.path, f.input, context); }, false, false, "PLY"};

}  // namespace fathom
