#pragma once
#include <filesystem>
#include <vector>

#include "fathom/description.h"

namespace fathom::cli {

/// Throws Error if one of the files to be written is `input`, by whatever name: links are followed, and files compared
/// by device and number.
///
/// what  the input is: "a texture of this scene"
void check_outputs_are_not(const std::vector<std::filesystem::path>& outputs, const std::filesystem::path& input,
                           const char* what);

/// The same of all that a scene was read from.
void check_outputs_are_no_inputs(const std::vector<std::filesystem::path>& outputs, const SceneDescription& scene);

}  // namespace fathom::cli
