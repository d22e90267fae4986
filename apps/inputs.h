#pragma once
#include <filesystem>
#include <vector>

#include "fathom/description.h"

namespace fathom::cli {

/// Throws Error if one of the files to be written is one that the picture is made from, by whatever name: links are
/// followed, and files compared by device and number.
void check_outputs_are_no_inputs(const std::vector<std::filesystem::path>& outputs, const SceneDescription& scene);

}  // namespace fathom::cli
