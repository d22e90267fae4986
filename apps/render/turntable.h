// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "render/still.h"

namespace fathom::cli {

/// Numbers the images of --turntable; throws UsageError if options contradict each other.
void check_turntable(RenderOptions& options);

/// Renders the images around a scene that does not change; returns the exit code.
int render_turntable(const RenderPlan& plan, const SeriesOptions& series, const Scene& scene, const Summary& summary,
                     Reporter& reporter);

}  // namespace fathom::cli
