#include "distributed/ranks/rank_checkpoint.h"

#include <fmt/format.h>

#include "commands/commands.h"
#include "distributed/ranks/follower.h"
#include "fathom/error.h"

namespace fathom::cli {

namespace fs = std::filesystem;

fs::path kept_samples(const RenderOptions& o, const PictureOptions& files)
{
    if (!o.checkpoint.empty()) return o.checkpoint;
    fs::path file = files.outputs.empty() ? o.scene.file.filename() : files.outputs.front();
    return file.replace_extension(".checkpoint.exr");
}

OwnSamples::OwnSamples(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files,
                       const RenderJob& job, const Summary& summary, Reporter& reporter)
    : film(job),
      samples_before(0),
      o_(o),
      plan_(plan),
      summary_(summary),
      states_(o, plan, files, reporter),
      all_(kept_samples(o, files)),
      file_(plan.ranks->leads() ? all_ : rank_file(all_, plan.ranks->rank())),
      checkpoint_(file_, o.every_s.value_or(default_every_s), reporter),
      kept_(0)
{
    if (o.checkpoint.empty() || !plan.ranks->leads()) return;
    film = checkpoint_.open(job, plan.range, plan.scene_parts);
    kept_ = samples_before = film.samples_per_pixel();
    if (!checkpoint_.has_rank_files()) return;
    // The ranks of this run will write files of the same names.
    write(film);
    if (!checkpoint_.finish())
        throw Error(all_.string(), "", "what earlier ranks have left beside it can't be written into it");
}

void OwnSamples::write(const Film& now)
{
    checkpoint_.write(now, plan_.settings.alpha, states_.state_attributes(now, summary_, 0));
    kept_ = now.samples_per_pixel();
}

void OwnSamples::keep_now_and_then(const Film& now, bool is_wanted)
{
    if (!o_.checkpoint.empty() && (is_wanted || checkpoint_.is_due())) write(now);
}

void OwnSamples::keep()
{
    if (film.samples_per_pixel() > kept_) write(film);
    checkpoint_.finish();
}

bool OwnSamples::keep_all()
{
    if (o_.checkpoint.empty()) return true;
    write(film);
    return checkpoint_.finish();
}

std::string OwnSamples::kept_text() const
{
    const std::string ranks = (all_.parent_path() / (all_.stem().string() + ".rank*.exr")).string();
    if (!o_.checkpoint.empty())
        return fmt::format("the samples so far are in {} and {}; the same command goes on from them", all_.string(),
                           ranks);
    return fmt::format("the samples so far are in {} and {}; the same command with --checkpoint {}{} goes on from them",
                       all_.string(), ranks, all_.string(),
                       o_.settings.guiding      ? ""
                       : plan_.settings.guiding ? " --guiding on"
                                                : " --guiding off");
}

void OwnSamples::remove()
{
    if (plan_.ranks->leads() && !o_.checkpoint.empty()) return;
    checkpoint_.finish();
    remove_states(file_);
}

}  // namespace fathom::cli
