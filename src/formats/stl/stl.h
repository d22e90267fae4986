// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "formats/common/importer.h"

namespace fathom {

/// Reads STL, ASCII and binary. Corners with equal positions become one vertex. The normals of the file are ignored,
/// because the order of the corners implies them.
SceneDescription read_stl(const std::filesystem::path& file, const std::string& bytes, LoadContext& context);

inline constexpr Importer stl_importer{
    [](const SourceFile& f) { return f.extension == ".stl"; },
    [](const SourceFile& f, LoadContext& context) { return read_stl(f.path, f.bytes(), context); }, false, true, "STL"};

}  // namespace fathom
