// SPDX-License-Identifier: Apache-2.0
#include "render/turntable.h"

#include "commands/commands.h"
#include "render/series.h"

namespace fathom::cli {

void check_turntable(RenderOptions& o)
{
    if (!o.series.frames.empty()) throw UsageError("--turntable, --frames: give one of them");
    for (std::uint64_t i = 0; i < o.series.turntable; ++i) o.series.frames.push_back(i);
    o.scene.turntable = true;
    check_series(o, "--turntable");
}

int render_turntable(const RenderPlan& plan, const SeriesOptions& series, const Scene& scene, const Summary& summary,
                     Reporter& reporter)
{
    for (const std::uint64_t i : series.frames) {
        const Camera camera = turntable_camera(scene.camera(), plan.scene, double(i) / double(series.turntable));
        const int code = render_image(plan, frame_files(plan.images, i), RenderJob(scene, camera, plan.settings),
                                      i == 0 ? summary : Summary{}, reporter);
        if (code != exit_ok) return code;
    }
    return exit_ok;
}

}  // namespace fathom::cli
