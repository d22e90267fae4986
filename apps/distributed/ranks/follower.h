// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "render/still.h"

namespace fathom::cli {

/// render_image() by all ranks together, bit for bit the image of one process. Rank 0 reports, writes the images and
/// returns the exit code; the others return exit_ok.
int render_over_ranks(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job, Summary summary,
                      Reporter& reporter);

}  // namespace fathom::cli
