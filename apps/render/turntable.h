#pragma once
#include "render/still.h"

namespace fathom::cli {

/// What --turntable says with the others; throws UsageError.
void check_turntable(RenderOptions& options);

/// The pictures around a scene, which stays as it is; returns the exit code.
int render_turntable(const RenderOptions& options, const RenderPlan& plan, const Scene& scene, const Summary& summary,
                     Reporter& reporter);

}  // namespace fathom::cli
