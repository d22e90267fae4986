#include "distributed/ranks/dispatcher.h"

#include <algorithm>
#include <cmath>

#include "options/sample_plan.h"

namespace fathom::cli {

namespace {

/// Of what would be a rank's share of all that is left it gets this at once: its speed may change.
constexpr double at_once = 0.5;
/// Ranges that take less time than this cost more to hand out than they bring.
constexpr double shortest_s = 0.1;
/// A range is at most so many times as long as the one before: what the first, small one tells of speed is not exact.
constexpr std::uint64_t growth = 8;

}  // namespace

Dispatcher::Dispatcher(std::vector<SampleRange> samples, int ranks, std::optional<double> end_s, bool nothing_yet)
    : todo_(std::move(samples)),
      left_(count_of(todo_)),
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
    double count = std::max(double(left_) * speed / all * at_once, shortest_s * asking.per_s);
    if (end_s_ && !nothing_yet_) {
        const double left_s = *end_s_ - now_s;
        // Before anybody's speed is known there is time for a sample as long as there is time.
        const bool any_known = std::any_of(ranks_.begin(), ranks_.end(), [](const Rank& r) { return r.per_s > 0; });
        const double fit = any_known ? std::floor(left_s * speed) : left_s > 0 ? 1 : 0;
        if (fit < 1) return {};
        count = std::min(count, fit);
    }
    const std::uint64_t most = asking.last == 0 ? 1 : asking.last * growth;
    SampleRange& first = todo_.back();
    const std::uint64_t samples =
        std::min({std::uint64_t(std::max(count, 1.0)), most, first.second - first.first, left_});
    const SampleRange range{first.first, first.first + samples};
    first.first = range.second;
    if (first.first == first.second) todo_.pop_back();
    left_ -= samples;
    asking.last = samples;
    nothing_yet_ = false;
    return range;
}

}  // namespace fathom::cli
