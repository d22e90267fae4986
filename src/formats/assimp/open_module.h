// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "formats/common/importer.h"

namespace fathom {

/// Reads FBX, Collada, 3DS and other formats of Assimp through the module beside this library. Throws Error if the
/// module is missing or can't read the file.
SceneDescription read_with_assimp(const std::filesystem::path& file, const LoadOptions& options, LoadContext& context);

/// The fallback for files that no other importer recognizes.
inline constexpr Importer assimp_importer{
    [](const SourceFile&) { return true; },
    [](const SourceFile& f, LoadContext& context) { return read_with_assimp(f.path, f.options, context); }};

}  // namespace fathom
