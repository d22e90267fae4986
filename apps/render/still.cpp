#include "render/still.h"

#include "commands/commands.h"
#include "distributed/ranks/follower.h"
#include "process/interrupt.h"
#include "render/checkpoint.h"
#include "render/image_writer.h"
#include "render/rendering.h"

namespace fathom::cli {

int render_picture(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files, const RenderJob& job,
                   Summary summary, Reporter& reporter)
{
    if (plan.ranks) return render_over_ranks(o, plan, files, job, summary, reporter);
    std::optional<Checkpoint> checkpoint;
    if (!o.checkpoint.empty()) checkpoint.emplace(o.checkpoint, o.every_s.value_or(default_every_s), reporter);
    Film film = checkpoint ? checkpoint->open(job, plan.range, plan.scene_parts) : Film(job);
    const std::uint64_t samples_before = film.samples_per_pixel();

    PictureWriter pictures(o, plan, files, reporter);
    Rendering rendering(o, job, reporter);
    const double start_s = seconds_since_start();
    const auto save = [&](const Film& now) {
        const double per_s = double(now.samples_per_pixel() - samples_before) / (seconds_since_start() - start_s);
        checkpoint->write(now, plan.settings.alpha, pictures.state_attributes(now, summary, per_s));
    };
    rendering.run(film, plan.range, [&](const Film& now) {
        const bool is_wanted = picture_is_wanted();
        if (checkpoint && (is_wanted || checkpoint->is_due())) save(now);
        if (is_wanted) pictures.write(now, summary);
    });
    summary.render_s = rendering.render_s;
    summary.costs = rendering.costs;
    summary.samples_per_pixel = film.samples_per_pixel();
    if (rendering.cut_short && film.samples().empty()) {
        reporter.error("interrupted before the first pass was done: no picture is written");
        return exit_interrupted;
    }

    const double write_start_s = seconds_since_start();
    if (checkpoint && (film.samples_per_pixel() > samples_before || checkpoint->has_rank_files())) save(film);
    const bool all_written = pictures.write(film, summary);
    if (checkpoint) checkpoint->finish();
    summary.write_s = seconds_since_start() - write_start_s;
    pictures.tell(film, summary, rendering.cut_short);
    if (!all_written) return exit_error;
    return rendering.cut_short ? exit_interrupted : exit_ok;
}

}  // namespace fathom::cli
