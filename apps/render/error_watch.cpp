// SPDX-License-Identifier: Apache-2.0
#include "render/error_watch.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace fathom::cli {

namespace {

/// Rounds up to a number with three significant bits, at which the points of a pixel are spread evenly.
std::uint64_t round_up(double samples)
{
    const auto whole = std::uint64_t(std::ceil(std::min(samples, double(max_samples))));
    const std::uint64_t step = std::max<std::uint64_t>(std::bit_floor(whole) / 4, 1);
    return (whole + step - 1) / step * step;
}

}  // namespace

void ErrorWatch::look(const Film& film)
{
    const double samples = double(film.samples_per_pixel());
    // Without a goal, looks only serve the forecast. In fast scenes they would take noticeable time.
    next_look_ = round_up((has_goal() ? 2 : 8) * samples);
    const std::optional<ImageError> estimate =
        estimate_error(film, options_.metric, has_goal() ? ErrorProbes::deciding : ErrorProbes::all);
    if (!estimate) return;
    looks_.push_back({samples, estimate->error});
    if (!has_goal()) return;
    is_reached_ = estimate->high <= *options_.goal && estimate->is_reliable();
    if (is_reached_ || !estimate->is_reliable()) return;
    constexpr double margin = 1.05;
    const double needed = margin * samples * std::pow(estimate->high / *options_.goal, 1 / rate(looks_));
    expected_samples_ = round_up(needed);
    next_look_ = std::min(next_look_, round_up(std::max(needed, samples + 1)));
}

std::optional<ImageError> ErrorWatch::final_error(const Film& film) const
{
    return estimate_error(film, options_.metric, has_goal() ? ErrorProbes::reporting : ErrorProbes::all);
}

double ErrorWatch::forecast(const Film& film, double error, double factor) const
{
    std::vector<Look> looks = looks_;
    const double samples = double(film.samples_per_pixel());
    if (looks.empty() || looks.back().samples != samples) looks.push_back({samples, error});
    return error * std::pow(factor, -rate(looks));
}

double ErrorWatch::rate(const std::vector<Look>& looks)
{
    // Independent samples have a rate of 0.5, and the best that evenly spread ones reach is 1.
    constexpr double independent = 0.5, best = 1;
    // A prior as strong as two looks a factor of 1.6 apart, so that the noise of close looks does not count.
    constexpr double prior = 0.12;
    constexpr std::size_t latest = 4;
    double xy = 0, xx = 0;
    const std::size_t first = looks.size() - std::min(latest, looks.size());
    for (std::size_t i = first; i < looks.size(); ++i)
        for (std::size_t j = first; j < i; ++j) {
            if (!(looks[i].error > 0 && looks[j].error > 0)) continue;
            const double x = std::log(looks[i].samples / looks[j].samples);
            xy += x * std::log(looks[j].error / looks[i].error), xx += x * x;
        }
    return std::clamp((xy + prior * independent) / (xx + prior), 0.25, best);
}

}  // namespace fathom::cli
