#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/common/importer.h"

namespace fathom {

/// Reads glTF 2.0, as JSON or as GLB; which of them the bytes tell. What the format can say and Fathom can't show
/// (unknown extensions, animation) is a warning; what the file calls required and isn't known is an Error.
///
/// bytes  the file's content
SceneDescription read_gltf(const std::filesystem::path& file, const std::string& bytes, const LoadOptions& options,
                           LoadContext& context);

/// A JSON file that is glTF has an "asset" with a version near its beginning or end; Fathom's scenes have none.
bool looks_like_gltf(std::string_view text);

inline constexpr Importer gltf_importer{
    [](const SourceFile& f) {
        const bool may_be_json = f.extension == ".json" || f.extension.empty();
        return f.head().starts_with("glTF") || f.extension == ".gltf" || f.extension == ".glb" ||
               (may_be_json && looks_like_gltf(f.bytes()));
    },
    [](const SourceFile& f, LoadContext& context) { return read_gltf(f.path, f.bytes(), f.options, context); }, true,
    false, "glTF 2.0"};

}  // namespace fathom
