// SPDX-License-Identifier: Apache-2.0
#include "render/frames.h"

#include "commands/commands.h"
#include "render/series.h"

namespace fathom::cli {

namespace {

double frame_time(const SeriesOptions& series, std::uint64_t frame)
{
    return double(frame) / series.fps;
}

/// Moves the scene to a frame, compiles it, and reports warnings that are not in `warnings` yet.
Scene compile_frame(const RenderPlan& plan, EditableScene& edit, double time_s, Warnings& warnings, Reporter& reporter)
{
    set_time(edit, plan.scene, plan.scene_options, time_s);
    Warnings found, fresh;
    Scene scene = edit.compile_bit_exact(found);
    for (const auto& [message, times] : found.counts())
        if (!warnings.counts().contains(message)) fresh.add(message, times);
    for (const auto& [message, times] : fresh.counts()) warnings.add(message, times);
    reporter.warnings(fresh);
    return scene;
}

}  // namespace

void check_frames(RenderOptions& o)
{
    const SeriesOptions& series = o.series;
    o.scene.shutter_s = series.shutter / series.fps;
    if (series.shutter > 0 && series.frames.empty() && !o.scene.at_s)
        throw UsageError("--shutter: opens at a time; add --at SECONDS or --frames A:B");
    if (series.frames.empty()) return;
    if (o.scene.at_s) throw UsageError("--at, --frames: give one of them");
    o.scene.at_s = frame_time(series, series.frames[0]);
    check_series(o, "--frames");
}

int render_frames(const RenderPlan& plan, const SeriesOptions& series, EditableScene& edit, LitScene first,
                  const Summary& summary, const Warnings& reported, Reporter& reporter)
{
    Warnings warnings = reported;
    Scene scene = std::move(first.scene);
    for (const std::uint64_t frame : series.frames) {
        Summary now = summary;
        if (frame != series.frames[0]) {
            const double start_s = seconds_since_start();
            // EditableScene would compile everything again if the last scene were still in use.
            scene = {};
            scene = compile_frame(plan, edit, frame_time(series, frame), warnings, reporter);
            now.load_s = 0;
            now.build_s = seconds_since_start() - start_s;
        }
        const int code =
            render_image(plan, frame_files(plan.images, frame), RenderJob(scene, plan.settings), now, reporter);
        if (code != exit_ok) return code;
    }
    return exit_ok;
}

}  // namespace fathom::cli
