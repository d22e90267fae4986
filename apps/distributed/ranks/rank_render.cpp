// SPDX-License-Identifier: Apache-2.0
#include "distributed/ranks/rank_render.h"

#include <cstring>

#include "commands/commands.h"
#include "process/interrupt.h"

namespace fathom::cli {

std::string RankReport::to_bytes() const
{
    return {reinterpret_cast<const char*>(this), sizeof *this};
}

RankReport RankReport::from_bytes(const std::string& bytes)
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

RankRender::RankRender(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job, const Summary& summary,
                       Reporter& reporter)
    : plan_(plan),
      ranks_(*plan.ranks),
      job_(job),
      own_(plan, files, job, summary, reporter),
      start_s_(seconds_since_start())
{
    const RenderSettings& settings = job.settings();
    const Crop crop = settings.rendered_pixels();
    pixels_ = std::uint64_t(crop.x1 - crop.x0) * std::uint64_t(crop.y1 - crop.y0);
}

void RankRender::render_and_save()
{
    try {
        render_ranges();
    } catch (...) {
        own_.save();
        throw;
    }
    if (interrupted() || !plan_.checkpoint.file.empty()) own_.save();
}

void RankRender::render_ranges()
{
    train_guiding();
    double sample_s = 0;
    while (!interrupted()) {
        const std::optional<SampleRange> range = next_range(sample_s);
        if (!range) return;
        const double begin_s = seconds_since_start();
        render_range(*range);
        sample_s = (seconds_since_start() - begin_s) / double(range->second - range->first);
    }
}

/// Runs before the first range, whose time is to measure the speed of rendering alone.
void RankRender::train_guiding()
{
    const double begin_s = seconds_since_start();
    render(job_, {0, 0}, own_.film, &interrupted());
    if (job_.settings().guiding && job_.settings().measure_stages)
        report_.costs.seconds[std::size_t(RenderStage::learn)] +=
            (seconds_since_start() - begin_s) * job_.settings().threads;
}

void RankRender::render_range(SampleRange range)
{
    const RankReport before = report_;
    render(job_, range, own_.film, &interrupted(), [&](const Progress& p, const Film&) {
        report_ = before;
        report_ += {p.samples_done, p.costs};
        after_pass(report_);
    });
}

}  // namespace fathom::cli
