// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace fathom::view {

/// Measures the time from a camera move until it is visible.
class LatencyLog {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// file  CSV with a line for each move; empty: none. Throws Error if it can't be written.
    explicit LatencyLog(const std::string& file);
    ~LatencyLog();
    LatencyLog(const LatencyLog&) = delete;
    LatencyLog& operator=(const LatencyLog&) = delete;

    /// Records a move.
    void record_move(std::uint64_t move, Time when);
    /// Records that a frame with `move`, and thus all earlier moves, is on the screen.
    void record_frame(std::uint64_t move, int width, int height, bool full_size, Time when);
    /// Whether all moves so far have been shown at full size.
    bool all_shown() const { return waiting_.empty(); }
    /// Medians and 95th percentiles in one line; empty without moves.
    std::string summary() const;

private:
    struct Move {
        std::uint64_t move;
        Time when;
        double first_ms = -1;
        int width = 0, height = 0;
    };
    std::FILE* file_ = nullptr;
    std::deque<Move> waiting_;
    std::vector<double> first_ms_, full_ms_;
};

}  // namespace fathom::view
