#pragma once
#include <filesystem>
#include <vector>

#include "options/render_options.h"

namespace fathom::cli {

/// Checks what several pictures mean for the other options, and names their files where no option does.
///
/// option  what asks for them
void check_series(RenderOptions& options, const char* option);

/// The files of a frame: its number stands where #### does, with as many digits at least.
PictureOptions files_of(PictureOptions options, std::uint64_t frame);
/// Those that will be written over, of all frames.
std::vector<std::filesystem::path> files_that_are_there(const RenderOptions& options);
/// Looks before a long render whether its files can be written. Throws Error.
void check_outputs(const RenderOptions& options, int width = 0, int height = 0);

}  // namespace fathom::cli
