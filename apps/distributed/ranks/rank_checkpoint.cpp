// SPDX-License-Identifier: Apache-2.0
#include "distributed/ranks/rank_checkpoint.h"

#include <fmt/format.h>

#include "commands/commands.h"
#include "fathom/error.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

/// The file for the samples of all ranks: the checkpoint, or without one a file beside the image.
fs::path merged_file(const RenderPlan& plan, const ImageOptions& files)
{
    if (!plan.checkpoint.file.empty()) return plan.checkpoint.file;
    fs::path file = files.outputs.empty() ? plan.scene_options.file.filename() : files.outputs.front();
    return file.replace_extension(".checkpoint.exr");
}

}  // namespace

RankCheckpoint::RankCheckpoint(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job,
                               const Summary& summary, Reporter& reporter)
    : film(job),
      samples_before(0),
      plan_(plan),
      summary_(summary),
      images_(plan, files, reporter),
      merged_file_(merged_file(plan, files)),
      file_(plan.ranks->leads() ? merged_file_ : rank_file(merged_file_, plan.ranks->rank())),
      checkpoint_({file_, plan.checkpoint.every_s}, reporter),
      saved_samples_(0)
{
    if (plan.checkpoint.file.empty() || !plan.ranks->leads()) return;
    film = checkpoint_.open(job, plan.samples.range, plan.scene_digest);
    saved_samples_ = samples_before = film.samples_per_pixel();
    if (!checkpoint_.has_rank_files()) return;
    // This run's ranks will overwrite the files of earlier ranks, so their samples are saved first.
    write(film);
    if (!checkpoint_.finish())
        throw Error(merged_file_.string(), "", "can't save the samples that ranks of an earlier run left beside it");
}

void RankCheckpoint::write(const Film& now)
{
    checkpoint_.write(now, plan_.settings.alpha, images_.checkpoint_attributes(now, summary_, 0));
    saved_samples_ = now.samples_per_pixel();
}

void RankCheckpoint::save_if_due(const Film& now, bool is_requested)
{
    if (!plan_.checkpoint.file.empty() && (is_requested || checkpoint_.is_due())) write(now);
}

void RankCheckpoint::save()
{
    if (film.samples_per_pixel() > saved_samples_) write(film);
    checkpoint_.finish();
}

bool RankCheckpoint::save_merged()
{
    if (plan_.checkpoint.file.empty()) return true;
    write(film);
    return checkpoint_.finish();
}

std::string RankCheckpoint::resume_hint() const
{
    const std::string ranks = (merged_file_.parent_path() / (merged_file_.stem().string() + ".rank*.exr")).string();
    if (!plan_.checkpoint.file.empty())
        return fmt::format("the samples so far are in {} and {}; the same command continues from them",
                           merged_file_.string(), ranks);
    return fmt::format(
        "the samples so far are in {} and {}; the same command with --checkpoint {}{} continues from them",
        merged_file_.string(), ranks, merged_file_.string(),
        plan_.has_guiding_option ? ""
        : plan_.settings.guiding ? " --guiding on"
                                 : " --guiding off");
}

void RankCheckpoint::remove()
{
    if (plan_.ranks->leads() && !plan_.checkpoint.file.empty()) return;
    checkpoint_.finish();
    remove_generations(file_);
}

}  // namespace fathom::cli
