// SPDX-License-Identifier: Apache-2.0
#include "latency_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "fathom/error.h"

namespace fathom::view {

namespace {

double percentile(std::vector<double> values, double part)
{
    std::sort(values.begin(), values.end());
    return values[std::size_t(std::max(0.0, std::ceil(part * double(values.size())) - 1))];
}

std::string median_and_95th(const std::vector<double>& values)
{
    return fmt::format("median {:.1f} ms, 95 % {:.1f} ms", percentile(values, 0.5), percentile(values, 0.95));
}

}  // namespace

LatencyLog::LatencyLog(const std::string& file)
{
    if (file.empty()) return;
    file_ = std::fopen(file.c_str(), "w");
    if (!file_) throw Error(file, "--log-latency", fmt::format("can't be written: {}", std::strerror(errno)));
    fmt::print(file_, "first_ms,first_width,first_height,full_ms\n");
}

LatencyLog::~LatencyLog()
{
    if (file_) std::fclose(file_);
}

void LatencyLog::record_move(std::uint64_t move, Time when)
{
    waiting_.push_back({move, when});
}

void LatencyLog::record_frame(std::uint64_t move, int width, int height, bool full_size, Time when)
{
    const auto ms_since = [&](Time start) { return std::chrono::duration<double, std::milli>(when - start).count(); };
    for (Move& m : waiting_) {
        if (m.move > move) break;
        if (m.first_ms >= 0) continue;
        m.first_ms = ms_since(m.when);
        m.width = width;
        m.height = height;
    }
    while (full_size && !waiting_.empty() && waiting_.front().move <= move) {
        const Move& m = waiting_.front();
        first_ms_.push_back(m.first_ms);
        full_ms_.push_back(ms_since(m.when));
        if (file_) {
            fmt::print(file_, "{:.2f},{},{},{:.2f}\n", m.first_ms, m.width, m.height, full_ms_.back());
            std::fflush(file_);
        }
        waiting_.pop_front();
    }
}

std::string LatencyLog::summary() const
{
    if (full_ms_.empty()) return {};
    return fmt::format("{} moves: first frame {}; full size {}", full_ms_.size(), median_and_95th(first_ms_),
                       median_and_95th(full_ms_));
}

}  // namespace fathom::view
