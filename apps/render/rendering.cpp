#include "rendering.h"

#include <algorithm>

#include "../commands.h"
#include "../interrupt.h"

namespace fathom::cli {

Rendering::Rendering(const RenderOptions& options, const RenderJob& job, Reporter& reporter)
    : options_(options), job_(job), reporter_(reporter), start_s_(seconds_since_start())
{
    const RenderSettings& settings = job.settings();
    const Crop crop = settings.crop.value_or(Crop{0, 0, settings.width, settings.height});
    pixels_ = std::uint64_t(crop.x1 - crop.x0) * std::uint64_t(crop.y1 - crop.y0);
}

void Rendering::run(Film& film, std::optional<std::uint64_t> samples)
{
    const std::uint64_t most = samples.value_or(most_samples);
    if (options_.range)
        render_range(film, *options_.range, options_.range->second - options_.range->first);
    else if (options_.time_s)
        render_for_time(film, *options_.time_s, most);
    else
        render_range(film, {0, most}, most);
    render_s = seconds_since_start() - start_s_;
}

void Rendering::render_range(Film& film, SampleRange range, std::uint64_t total)
{
    Progress last;
    const auto on_pass = [&](const Progress& p, const Film&) {
        last = p;
        report(p, total);
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

void Rendering::render_for_time(Film& film, double time_s, std::uint64_t most)
{
    std::uint64_t done = 0, next = 1;
    while (true) {
        const double begin_s = seconds_since_start();
        render_range(film, {done, done + next}, most);
        if (cut_short) return;
        done += next;
        const double now_s = seconds_since_start();
        // The rate of the latest range: the first ones are slower, with cold caches.
        const double sample_s = std::max((now_s - begin_s) / double(next), 1e-9);
        const double fit = std::max(0.0, (time_s - now_s) / sample_s);
        next = std::min({done, most - done, std::uint64_t(std::min(fit, 1e15))});
        if (next == 0) return;
    }
}

}  // namespace fathom::cli
