// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "render/still.h"

namespace fathom::cli {

/// Applies --frames, --fps and --shutter to the scene's time; throws UsageError if options contradict each other.
void check_frames(RenderOptions& options);

/// Renders the images of all frames, starting with a scene of the first; returns the exit code.
///
/// reported  warnings of the first frame; later ones only add new ones
int render_frames(const RenderPlan& plan, const SeriesOptions& series, EditableScene& edit, LitScene first,
                  const Summary& summary, const Warnings& reported, Reporter& reporter);

}  // namespace fathom::cli
