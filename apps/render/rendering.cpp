// SPDX-License-Identifier: Apache-2.0
#include "render/rendering.h"

#include <algorithm>

#include "commands/commands.h"
#include "options/sample_plan.h"

namespace fathom::cli {

Rendering::Rendering(const RenderJob& job, std::optional<double> time_s, ErrorWatch& watch,
                     const std::atomic<bool>& cancel, Reporter& reporter)
    : job_(job), time_s_(time_s), watch_(watch), cancel_(cancel), reporter_(reporter), start_s_(seconds_since_start())
{
    const RenderSettings& settings = job.settings();
    const Crop crop = settings.rendered_pixels();
    pixels_ = std::uint64_t(crop.x1 - crop.x0) * std::uint64_t(crop.y1 - crop.y0);
}

void Rendering::run(Film& film, SampleRange wanted, std::function<void(const Film&)> after_pass)
{
    after_pass_ = std::move(after_pass);
    const std::vector<SampleRange> todo = missing_samples(film.samples(), wanted);
    total_ = count_samples(todo);
    before_ = film.samples_per_pixel();
    if (watch_.has_goal() && before_ > 0) watch_.look(film);
    for (SampleRange range : todo)
        while (range.first < range.second && !was_interrupted && !was_time_up && !watch_.is_reached()) {
            const std::uint64_t count = next_count(film, range.second - range.first);
            if (count == 0) {
                was_time_up = true;
                break;
            }
            const double begin_s = seconds_since_start();
            render_range(film, {range.first, range.first + count});
            range.first += count;
            rendered_ += count;
            // Only the latest range counts: the first ones are slower, since caches are cold.
            sample_s_ = std::max((seconds_since_start() - begin_s) / double(count), 1e-9);
        }
    render_s = seconds_since_start() - start_s_;
}

std::uint64_t Rendering::next_count(const Film& film, std::uint64_t most) const
{
    std::uint64_t count = most;
    if (watch_.has_goal()) count = std::min(count, watch_.next_look() - film.samples_per_pixel());
    if (!time_s_) return count;
    // Ranges double in size, so that their overhead is small, until the next one would end too late.
    if (rendered_ == 0) return 1;
    const double fit = std::max(0.0, (*time_s_ - seconds_since_start()) / sample_s_);
    return std::min({count, rendered_, std::uint64_t(std::min(fit, 1e15))});
}

void Rendering::render_range(Film& film, SampleRange range)
{
    Progress last;
    const auto on_pass = [&](const Progress& p, const Film& so_far) {
        last = p;
        report(p);
        after_pass_(so_far);
        // The final report estimates the error of the whole run.
        const bool is_end = so_far.samples_per_pixel() == before_ + total_;
        if (so_far.samples_per_pixel() >= watch_.next_look() && (watch_.has_goal() || !is_end)) watch_.look(so_far);
    };
    was_interrupted = !render(job_, range, film, &cancel_, on_pass);
    done_ += was_interrupted ? last.samples_done : pixels_ * (range.second - range.first);
    costs += last.costs;
    report({}, !was_interrupted);
}

const char* Rendering::end() const
{
    if (was_interrupted) return "the render was interrupted";
    return was_time_up ? "the time is up" : "all samples are rendered";
}

double Rendering::fraction_done(std::uint64_t samples_done, double now_s) const
{
    const double per_pixel = double(samples_done) / double(pixels_);
    double fraction = time_s_ ? now_s / *time_s_ : per_pixel / double(total_);
    if (watch_.has_goal() && watch_.expected_samples() > 0)
        fraction = std::max(fraction, (double(before_) + per_pixel) / double(watch_.expected_samples()));
    return fraction;
}

void Rendering::report(const Progress& p, bool force)
{
    const double now_s = seconds_since_start();
    const std::uint64_t done = done_ + p.samples_done;
    // With a time limit or an error to reach, the number of samples is unknown in advance.
    const bool is_open = time_s_ || watch_.has_goal();
    Progress progress{done, is_open ? 0 : pixels_ * total_, costs};
    progress.costs += p.costs;
    reporter_.progress(fraction_done(done, now_s), now_s - start_s_, progress, force && !is_open);
}

}  // namespace fathom::cli
