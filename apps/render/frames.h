#pragma once
#include "fathom/edit.h"
#include "render/still.h"

namespace fathom::cli {

/// What --frames, --at and --shutter say with the others; throws UsageError.
void check_frames(RenderOptions& options);

/// The pictures of all frames, the scene being at the first; returns the exit code.
///
/// told  what was warned of; the frames after the first only tell what is new
int render_frames(const RenderOptions& options, const RenderPlan& plan, SceneEdit& edit, Scene scene,
                  const Summary& summary, const Warnings& told, Reporter& reporter);

}  // namespace fathom::cli
