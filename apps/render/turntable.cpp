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
    std::vector<Camera> cameras;
    for (const std::uint64_t i : series.frames)
        cameras.push_back(turntable_camera(scene.camera(), plan.scene, double(i) / double(series.turntable)));
    return render_images(plan, scene, cameras, summary, reporter);
}

}  // namespace fathom::cli
