// SPDX-License-Identifier: Apache-2.0
#include "render/still.h"

#include "commands/commands.h"
#include "distributed/ranks/follower.h"
#include "process/interrupt.h"
#include "render/checkpoint.h"
#include "render/image_writer.h"
#include "render/rendering.h"
#include "render/series.h"

namespace fathom::cli {

int render_image(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job, Summary summary,
                 Reporter& reporter)
{
    if (plan.ranks) return render_over_ranks(plan, files, job, summary, reporter);
    std::optional<Checkpoint> checkpoint;
    if (!plan.checkpoint.file.empty()) checkpoint.emplace(plan.checkpoint, reporter);
    Film film = checkpoint ? checkpoint->open(job, plan.samples.range, plan.scene_digest) : Film(job);
    const std::uint64_t samples_before = film.samples_per_pixel();

    ImageWriter images(plan, files, reporter);
    images.add_ground_truth(job);
    ErrorWatch watch(plan.samples.error);
    Rendering rendering(job, plan.samples.time_s, watch, interrupted(), reporter);
    const double start_s = seconds_since_start();
    const auto save = [&](const Film& now) {
        const double per_s = double(now.samples_per_pixel() - samples_before) / (seconds_since_start() - start_s);
        checkpoint->write(now, plan.settings.alpha, images.checkpoint_attributes(now, summary, per_s));
    };
    rendering.run(film, plan.samples.range, [&](const Film& now) {
        const bool is_requested = image_is_requested();
        if (checkpoint && (is_requested || checkpoint->is_due())) save(now);
        if (is_requested) images.write(now, summary);
    });
    summary.render_s = rendering.render_s;
    summary.costs = rendering.costs;
    summary.samples_per_pixel = film.samples_per_pixel();
    if (rendering.was_interrupted && film.samples().empty()) {
        reporter.error("interrupted before the first pass was done: no image is written");
        return exit_interrupted;
    }

    const double write_start_s = seconds_since_start();
    if (checkpoint && (film.samples_per_pixel() > samples_before || checkpoint->has_rank_files())) save(film);
    const bool all_written = images.write(film, summary);
    if (checkpoint) checkpoint->finish();
    summary.write_s = seconds_since_start() - write_start_s;
    images.report_result(film, summary, rendering.was_interrupted, {watch, rendering.end()});
    if (!all_written) return exit_error;
    if (rendering.was_interrupted) return exit_interrupted;
    if (!images.is_like_reference(film, summary)) return exit_not_reference;
    return watch.has_goal() && !watch.is_reached() ? exit_not_reached : exit_ok;
}

int render_images(const RenderPlan& plan, const Scene& scene, const std::vector<Camera>& cameras,
                  const Summary& summary, Reporter& reporter)
{
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const int code = render_image(plan, frame_files(plan.images, i), RenderJob(scene, cameras[i], plan.settings),
                                      i == 0 ? summary : Summary{}, reporter);
        if (code != exit_ok) return code;
    }
    return exit_ok;
}

}  // namespace fathom::cli
