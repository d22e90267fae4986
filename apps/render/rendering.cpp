// SPDX-License-Identifier: Apache-2.0
#include "render/rendering.h"

#include <algorithm>

#include "commands/commands.h"
#include "options/sample_plan.h"

namespace fathom::cli {

Rendering::Rendering(const RenderJob& job, std::optional<double> time_s, const std::atomic<bool>& cancel,
                     Reporter& reporter)
    : job_(job), time_s_(time_s), cancel_(cancel), reporter_(reporter), start_s_(seconds_since_start())
{
    const RenderSettings& settings = job.settings();
    const Crop crop = settings.rendered_pixels();
    pixels_ = std::uint64_t(crop.x1 - crop.x0) * std::uint64_t(crop.y1 - crop.y0);
}

void Rendering::run(Film& film, SampleRange wanted, std::function<void(const Film&)> after_pass)
{
    after_pass_ = std::move(after_pass);
    const std::vector<SampleRange> todo = missing_samples(film.samples(), wanted);
    const std::uint64_t total = count_samples(todo);
    if (time_s_) render_for_time(film, *time_s_, todo);
    for (std::size_t i = 0; i < todo.size() && !time_s_ && !was_interrupted; ++i) render_range(film, todo[i], total);
    render_s = seconds_since_start() - start_s_;
}

void Rendering::render_range(Film& film, SampleRange range, std::uint64_t total)
{
    Progress last;
    const auto on_pass = [&](const Progress& p, const Film& so_far) {
        last = p;
        report(p, total);
        after_pass_(so_far);
    };
    was_interrupted = !render(job_, range, film, &cancel_, on_pass);
    done_ += was_interrupted ? last.samples_done : pixels_ * (range.second - range.first);
    costs += last.costs;
    report({}, total, !was_interrupted);
}

void Rendering::report(const Progress& p, std::uint64_t total, bool force)
{
    const double now_s = seconds_since_start();
    const std::uint64_t done = done_ + p.samples_done;
    // With a time limit, the number of samples is unknown in advance, so progress goes by time.
    const double fraction = time_s_ ? now_s / *time_s_ : double(done) / double(pixels_ * total);
    Progress progress{done, time_s_ ? 0 : pixels_ * total, costs};
    progress.costs += p.costs;
    reporter_.progress(fraction, now_s - start_s_, progress, force && !time_s_);
}

void Rendering::render_for_time(Film& film, double time_s, std::vector<SampleRange> todo)
{
    std::uint64_t done = 0, count = 1;
    for (std::size_t i = 0; i < todo.size();) {
        SampleRange& range = todo[i];
        const std::uint64_t end = std::min(range.second, range.first + count);
        const double begin_s = seconds_since_start();
        render_range(film, {range.first, end}, range.second - range.first);
        if (was_interrupted) return;
        const double now_s = seconds_since_start();
        // Only the latest range counts: the first ones are slower, since caches are cold.
        const double sample_s = std::max((now_s - begin_s) / double(end - range.first), 1e-9);
        done += end - range.first;
        range.first = end;
        if (range.first == range.second) ++i;
        const double fit = std::max(0.0, (time_s - now_s) / sample_s);
        count = std::min(done, std::uint64_t(std::min(fit, 1e15)));
        if (count == 0) return;
    }
}

}  // namespace fathom::cli
