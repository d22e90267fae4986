// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/common/importer.h"

namespace fathom {

/// Reads scenes of pbrt-v4, plain or compressed by gzip; docs/formats.md lists all plugins. Unsupported features and
/// unread parameters are counted warnings.
SceneDescription read_pbrt(const SourceFile& file, LoadContext& context);

inline constexpr Importer pbrt_importer{
    [](const SourceFile& f) {
        return f.extension == ".pbrt" || (f.extension == ".gz" && f.path.stem().extension() == ".pbrt");
    },
    [](const SourceFile& f, LoadContext& context) { return read_pbrt(f, context); }};

}  // namespace fathom
