// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string_view>

#include "formats/common/importer.h"

namespace fathom {

/// Reads Fathom's own scene format, which docs/scene-format.md specifies.
///
/// text  content of the file
SceneDescription read_fathom_json(const std::filesystem::path& file, std::string_view text, LoadContext& context);

/// Whether the text begins with an object, which identifies JSON in files without a name such as /dev/stdin.
bool begins_as_object(std::string_view text);

inline constexpr Importer fathom_json_importer{
    [](const SourceFile& f) { return f.extension == ".json" || (f.extension.empty() && begins_as_object(f.bytes())); },
    [](const SourceFile& f, LoadContext& context) { return read_fathom_json(f.path, f.bytes(), context); }, false,
    false, "scene of Fathom"};

}  // namespace fathom
