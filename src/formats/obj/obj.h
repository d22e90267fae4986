// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "formats/common/importer.h"

namespace fathom {

/// Reads Wavefront OBJ with its MTL files: polygons, normals, texture coordinates and vertex colors. Each combination
/// of object and material becomes a mesh. Points (`p`, or all vertices of a file without faces) become spheres (see
/// fitting_points). Curves and lines are a counted warning.
SceneDescription read_obj(const std::filesystem::path& file, InputFile& input, LoadContext& context);

/// The name up to whitespace and '#'. The rest may be a comment or part of the name ("Material #25"), so callers look
/// up the whole name first.
std::string_view before_comment(std::string_view name);

/// Adds the materials of an MTL file to the scene, and their indices to `by_name`. Throws Error.
void read_mtl(const std::filesystem::path& file, std::string_view text, SceneDescription& scene,
              std::map<std::string, int, std::less<>>& by_name, Warnings& warnings);

inline constexpr Importer obj_importer{
    [](const SourceFile& f) { return f.extension == ".obj"; },
    [](const SourceFile& f, LoadContext& context) { return read_obj(f.path, f.input, context); }, false, false, "OBJ"};

}  // namespace fathom
