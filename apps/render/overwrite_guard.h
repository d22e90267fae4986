// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vector>

#include "fathom/description.h"

namespace fathom::cli {

/// Throws Error if an output is the file `input` under any name: links are followed, and files are compared by device
/// and inode.
///
/// what  the input in words: "a texture of this scene"
void check_outputs_are_not(const std::vector<std::filesystem::path>& outputs, const std::filesystem::path& input,
                           const char* what);

/// Throws Error if an output is a file that the scene was read from.
void check_outputs_are_no_inputs(const std::vector<std::filesystem::path>& outputs, const SceneDescription& scene);

}  // namespace fathom::cli
