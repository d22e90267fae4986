#pragma once
#include <filesystem>
#include <string_view>

#include "formats/common/importer.h"

namespace fathom {

/// Reads Fathom's own scene file: docs/scene-format.md says what may stand in it.
///
/// text  the file's content
SceneDescription read_fathom_json(const std::filesystem::path& file, std::string_view text, LoadContext& context);

/// As JSON does whose file has no name, as /dev/stdin.
bool begins_as_object(std::string_view text);

inline constexpr Importer fathom_json_importer{
    [](const SourceFile& f) { return f.extension == ".json" || (f.extension.empty() && begins_as_object(f.bytes())); },
    [](const SourceFile& f, LoadContext& context) { return read_fathom_json(f.path, f.bytes(), context); }, false,
    false, "scene of Fathom"};

}  // namespace fathom
