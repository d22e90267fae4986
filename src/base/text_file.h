// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string_view>

#include "fathom/api.h"

namespace fathom {

/// Writes a file atomically: to a temporary file in the same folder, which is synced and then renamed. Throws Error
/// naming `file` if that fails; an earlier file then remains.
FATHOM_API void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace fathom
