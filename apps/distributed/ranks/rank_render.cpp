#include "distributed/ranks/rank_render.h"

#include <cstring>

#include "commands/commands.h"
#include "process/interrupt.h"

namespace fathom::cli {

std::string RankReport::bytes() const
{
    return {reinterpret_cast<const char*>(this), sizeof *this};
}

RankReport RankReport::of(const std::string& bytes)
{
    RankReport report;
    if (bytes.size() == sizeof report) std::memcpy(&report, bytes.data(), sizeof report);
    return report;
}

RankReport& RankReport::operator+=(const RankReport& o)
{
    done += o.done;
    costs += o.costs;
    return *this;
}

SharedPicture::SharedPicture(const RenderOptions& o, const RenderPlan& plan, const PictureOptions& files,
                             const RenderJob& job, const Summary& summary, Reporter& reporter)
    : o_(o),
      plan_(plan),
      ranks_(*plan.ranks),
      job_(job),
      own_(o, plan, files, job, summary, reporter),
      start_s_(seconds_since_start())
{
    const RenderSettings& settings = job.settings();
    const Crop crop = settings.rendered_pixels();
    pixels_ = std::uint64_t(crop.x1 - crop.x0) * std::uint64_t(crop.y1 - crop.y0);
}

void SharedPicture::render_and_keep()
{
    try {
        render_ranges();
    } catch (...) {
        own_.keep();
        throw;
    }
    if (interrupted() || !o_.checkpoint.empty()) own_.keep();
}

void SharedPicture::render_ranges()
{
    learn();
    double sample_s = 0;
    while (!interrupted()) {
        const std::optional<SampleRange> range = next(sample_s);
        if (!range) return;
        const double begin_s = seconds_since_start();
        render_range(*range);
        sample_s = (seconds_since_start() - begin_s) / double(range->second - range->first);
    }
}

/// Before the first range: what that takes is to tell how fast this rank is.
void SharedPicture::learn()
{
    const double begin_s = seconds_since_start();
    render(job_, {0, 0}, own_.film, &interrupted());
    if (job_.settings().guiding && job_.settings().measure)
        report_.costs.seconds[std::size_t(RenderStage::learn)] +=
            (seconds_since_start() - begin_s) * job_.settings().threads;
}

void SharedPicture::render_range(SampleRange range)
{
    const RankReport before = report_;
    render(job_, range, own_.film, &interrupted(), [&](const Progress& p, const Film&) {
        report_ = before;
        report_ += {p.samples_done, p.costs};
        after_pass(report_);
    });
}

}  // namespace fathom::cli
