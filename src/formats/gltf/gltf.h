// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/common/importer.h"

namespace fathom {

/// Reads glTF 2.0 as JSON or GLB, which is recognized by content. Parts that Fathom can't render (such as unknown
/// extensions) are warnings; unknown extensions that the file requires are errors.
///
/// bytes  content of the file
SceneDescription read_gltf(const std::filesystem::path& file, const std::string& bytes, const LoadOptions& options,
                           LoadContext& context);

/// Whether a JSON text is glTF: it has an "asset" with a version near its beginning or end, unlike Fathom's scenes.
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
