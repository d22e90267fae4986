#include "render/turntable.h"

#include "commands/commands.h"
#include "render/series.h"

namespace fathom::cli {

void check_turntable(RenderOptions& o)
{
    if (!o.frames.empty()) throw UsageError("--turntable, --frames: one of both says which pictures");
    for (std::uint64_t i = 0; i < o.turntable; ++i) o.frames.push_back(i);
    o.scene.turntable = true;
    check_series(o, "--turntable");
}

int render_turntable(const RenderOptions& o, const RenderPlan& plan, const Scene& scene, const Summary& summary,
                     Reporter& reporter)
{
    for (const std::uint64_t i : o.frames) {
        const Camera camera = turned_camera(scene.camera(), plan.scene, double(i) / double(o.turntable));
        const int code = render_picture(o, plan, files_of(o.picture, i), RenderJob(scene, camera, plan.settings),
                                        i == 0 ? summary : Summary{}, reporter);
        if (code != exit_ok) return code;
    }
    return exit_ok;
}

}  // namespace fathom::cli
