#include "render/rendering.h"

#include <algorithm>

#include "commands/commands.h"
#include "options/sample_plan.h"
#include "process/interrupt.h"

namespace fathom::cli {

Rendering::Rendering(const RenderOptions& options, const RenderJob& job, Reporter& reporter)
    : options_(options), job_(job), reporter_(reporter), start_s_(seconds_since_start())
{
    const RenderSettings& settings = job.settings();
    const Crop crop = settings.rendered_pixels();
    pixels_ = std::uint64_t(crop.x1 - crop.x0) * std::uint64_t(crop.y1 - crop.y0);
}

void Rendering::run(Film& film, SampleRange wanted, std::function<void(const Film&)> after_pass)
{
    after_pass_ = std::move(after_pass);
    const std::vector<SampleRange> todo = missing_samples(film.samples(), wanted);
    const std::uint64_t total = count_of(todo);
    if (options_.time_s) render_for_time(film, *options_.time_s, todo);
    for (std::size_t i = 0; i < todo.size() && !options_.time_s && !cut_short; ++i) render_range(film, todo[i], total);
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
    cut_short = !render(job_, range, film, &interrupted(), on_pass);
    done_ += cut_short ? last.samples_done : pixels_ * (range.second - range.first);
    costs += last.costs;
    report({}, total, !cut_short);
}

void Rendering::report(const Progress& p, std::uint64_t total, bool force)
{
    const double now_s = seconds_since_start();
    const std::uint64_t done = done_ + p.samples_done;
    // With a time limit the samples to come are not known; the time is.
    const double fraction = options_.time_s ? now_s / *options_.time_s : double(done) / double(pixels_ * total);
    Progress progress{done, options_.time_s ? 0 : pixels_ * total, costs};
    progress.costs += p.costs;
    reporter_.progress(fraction, now_s - start_s_, progress, force && !options_.time_s);
}

void Rendering::render_for_time(Film& film, double time_s, std::vector<SampleRange> todo)
{
    std::uint64_t done = 0, count = 1;
    for (std::size_t i = 0; i < todo.size();) {
        SampleRange& range = todo[i];
        const std::uint64_t end = std::min(range.second, range.first + count);
        const double begin_s = seconds_since_start();
        render_range(film, {range.first, end}, range.second - range.first);
        if (cut_short) return;
        const double now_s = seconds_since_start();
        // The rate of the latest range: the first ones are slower, with cold caches.
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
