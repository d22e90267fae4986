#pragma once
#include <filesystem>
#include <string_view>

#include "fathom/api.h"

namespace fathom {

/// Writes a file whole or not at all, as pictures are: beside its place, then renamed. Throws Error naming the file.
FATHOM_API void write_text_file(const std::filesystem::path& file, std::string_view text);

}  // namespace fathom
