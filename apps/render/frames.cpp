#include "render/frames.h"

#include "commands/commands.h"
#include "render/series.h"

namespace fathom::cli {

namespace {

double time_of(const RenderOptions& o, std::uint64_t frame)
{
    return double(frame) / o.fps;
}

}  // namespace

void check_frames(RenderOptions& o)
{
    o.scene.shutter_s = o.shutter / o.fps;
    if (o.shutter > 0 && o.frames.empty() && !o.scene.at_s)
        throw UsageError("--shutter: from which time on? add --at SECONDS, or --frames A:B");
    if (o.frames.empty()) return;
    if (o.scene.at_s) throw UsageError("--at, --frames: one of both says the time");
    o.scene.at_s = time_of(o, o.frames[0]);
    check_series(o, "--frames");
}

int render_frames(const RenderOptions& o, const RenderPlan& plan, SceneEdit& edit, Scene scene, const Summary& summary,
                  const Warnings& told, Reporter& reporter)
{
    Warnings warnings = told;
    for (const std::uint64_t frame : o.frames) {
        Summary now = summary;
        if (frame != o.frames[0]) {
            const double start_s = seconds_since_start();
            // What still has a scene keeps it from being changed.
            scene = {};
            set_time(edit, plan.scene, o.scene, time_of(o, frame));
            Warnings found, fresh;
            scene = edit.compile_exactly(found);
            for (const auto& [message, times] : found.counts())
                if (!warnings.counts().contains(message)) fresh.add(message, times);
            for (const auto& [message, times] : fresh.counts()) warnings.add(message, times);
            reporter.warnings(fresh);
            now.load_s = 0;
            now.build_s = seconds_since_start() - start_s;
        }
        const int code =
            render_picture(o, plan, files_of(o.picture, frame), RenderJob(scene, plan.settings), now, reporter);
        if (code != exit_ok) return code;
    }
    return exit_ok;
}

}  // namespace fathom::cli
