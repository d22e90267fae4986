// SPDX-License-Identifier: Apache-2.0
#include "distributed/ranks/dispatcher.h"

#include <algorithm>
#include <cmath>

#include "options/sample_plan.h"

namespace fathom::cli {

namespace {

/// Fraction of its share of the remaining samples that a rank gets at once, since its speed may change.
constexpr double at_once = 0.5;
/// Shorter ranges are not worth the message that requests them.
constexpr double min_range_s = 0.1;
/// Limit on the length of a range over the one before, since short ranges give inexact speeds.
constexpr std::uint64_t max_growth = 8;

}  // namespace

Dispatcher::Dispatcher(std::vector<SampleRange> samples, int ranks, std::optional<double> end_s, bool nothing_yet)
    : todo_(std::move(samples)),
      left_(count_samples(todo_)),
      ranks_(std::size_t(ranks)),
      end_s_(end_s),
      nothing_yet_(nothing_yet)
{
    std::reverse(todo_.begin(), todo_.end());
}

double Dispatcher::speed_of(const Rank& rank) const
{
    if (rank.per_s > 0) return rank.per_s;
    double sum = 0, known = 0;
    for (const Rank& other : ranks_)
        if (other.per_s > 0) sum += other.per_s, ++known;
    return known > 0 ? sum / known : 1;
}

bool Dispatcher::is_too_slow(std::size_t rank) const
{
    double others = 0, fastest = 0;
    for (std::size_t i = 0; i < ranks_.size(); ++i) {
        if (i == rank) continue;
        const double speed = ranks_[i].per_s;
        others += speed;
        fastest = std::max(fastest, speed);
    }
    const double own = ranks_[rank].per_s;
    return own > 0 && fastest > own && 1 / own > double(left_) / others + 1 / fastest;
}

std::optional<SampleRange> Dispatcher::next(int rank, double sample_s, double now_s)
{
    Rank& asking = ranks_[std::size_t(rank)];
    if (sample_s > 0) asking.per_s = 1 / sample_s;
    if (left_ == 0 || is_too_slow(std::size_t(rank))) return {};

    double all = 0;
    for (const Rank& other : ranks_) all += speed_of(other);
    const double speed = speed_of(asking);
    double count = std::max(double(left_) * speed / all * at_once, min_range_s * asking.per_s);
    if (end_s_ && !nothing_yet_) {
        const double left_s = *end_s_ - now_s;
        // Until some speed is known, a sample is assumed to fit if any time is left.
        const bool any_known = std::any_of(ranks_.begin(), ranks_.end(), [](const Rank& r) { return r.per_s > 0; });
        const double fit = any_known ? std::floor(left_s * speed) : left_s > 0 ? 1 : 0;
        if (fit < 1) return {};
        count = std::min(count, fit);
    }
    const std::uint64_t max_samples = asking.last == 0 ? 1 : asking.last * max_growth;
    SampleRange& first = todo_.back();
    const std::uint64_t samples =
        std::min({std::uint64_t(std::max(count, 1.0)), max_samples, first.second - first.first, left_});
    const SampleRange range{first.first, first.first + samples};
    first.first = range.second;
    if (first.first == first.second) todo_.pop_back();
    left_ -= samples;
    asking.last = samples;
    nothing_yet_ = false;
    return range;
}

}  // namespace fathom::cli
