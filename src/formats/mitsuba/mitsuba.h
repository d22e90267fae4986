// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/common/importer.h"
#include "formats/io/text_encoding.h"

namespace fathom {

/// Reads Mitsuba 3 scenes (XML) as its variant `llvm_ad_rgb` interprets them; docs/formats.md lists all plugins.
/// Unsupported features and unread parameters are counted warnings.
SceneDescription read_mitsuba(const SourceFile& file, LoadContext& context);

inline constexpr Importer mitsuba_importer{
    [](const SourceFile& f) {
        return f.extension == ".xml" && (is_wide_text(f.head()) || f.bytes().find("<scene") != std::string::npos);
    },
    [](const SourceFile& f, LoadContext& context) { return read_mitsuba(f, context); }, false, false, "Mitsuba 3"};

}  // namespace fathom
