#pragma once
#include <filesystem>

#include "formats/common/importer.h"

namespace fathom {

/// Reads FBX, Collada, 3DS and whatever else Assimp knows, through the module beside this library. Throws Error if the
/// module isn't there or can't read the file.
SceneDescription read_with_assimp(const std::filesystem::path& file, const LoadOptions& options, LoadContext& context);

/// Takes whatever no other importer knows.
inline constexpr Importer assimp_importer{
    [](const SourceFile&) { return true; },
    [](const SourceFile& f, LoadContext& context) { return read_with_assimp(f.path, f.options, context); }};

}  // namespace fathom
