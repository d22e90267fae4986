#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "formats/common/importer.h"

namespace fathom {

/// Reads Wavefront OBJ with its MTL files: polygons, given normals, texture coordinates, vertex colours. Each object
/// and material is a mesh. Points (`p`, or all vertices of a file without faces) become balls, see add_point_cloud;
/// curves and lines are a counted warning.
SceneDescription read_obj(const std::filesystem::path& file, InputFile& input, LoadContext& context);

/// A name up to a blank and a '#'. What follows may be a comment or belong to the name ("Material #25"): readers look
/// for the whole name first.
std::string_view before_comment(std::string_view name);

/// Adds the materials of an MTL file to the scene, and their indices to `by_name`.
void read_mtl(const std::filesystem::path& file, std::string_view text, SceneDescription& scene,
              std::map<std::string, int, std::less<>>& by_name, Warnings& warnings);

inline constexpr Importer obj_importer{
    [](const SourceFile& f) { return f.extension == ".obj"; },
    [](const SourceFile& f, LoadContext& context) { return read_obj(f.path, f.input, context); }, false, false, "OBJ"};

}  // namespace fathom
