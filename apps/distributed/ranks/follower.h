#pragma once
#include "render/still.h"

namespace fathom::cli {

/// render_picture() by all ranks together, with the bits of one process. Returns the exit code at rank 0, which tells
/// of it and writes the pictures; the others return exit_ok.
int render_over_ranks(const RenderOptions& options, const RenderPlan& plan, const PictureOptions& files,
                      const RenderJob& job, Summary summary, Reporter& reporter);

/// Where ranks keep their samples if the run is cut off: the checkpoint, or without one a file beside the picture.
std::filesystem::path kept_samples(const RenderOptions& options, const PictureOptions& files);

}  // namespace fathom::cli
