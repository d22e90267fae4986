// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vector>

#include "options/render_options.h"

namespace fathom::cli {

/// Checks that the other options fit several images, and names their files where no option does. Throws UsageError.
///
/// option  the one that asks for several images
void check_series(RenderOptions& options, const char* option);

/// The files of one frame: its number replaces ####, with at least as many digits.
ImageOptions frame_files(ImageOptions options, std::uint64_t frame);
/// Existing files that will be overwritten, of all frames.
std::vector<std::filesystem::path> existing_outputs(const RenderOptions& options);
/// Throws Error if a file can't be written: better before a long render than after it.
void check_outputs(const RenderOptions& options, int width = 0, int height = 0);

}  // namespace fathom::cli
