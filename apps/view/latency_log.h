#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace fathom::view {

/// How long it takes until a camera move is seen.
class LatencyLog {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// file  where the times go, line by line; empty: nowhere. Throws Error if it can't be written.
    explicit LatencyLog(const std::string& file);
    ~LatencyLog();
    LatencyLog(const LatencyLog&) = delete;
    LatencyLog& operator=(const LatencyLog&) = delete;

    void moved(std::uint64_t move, Time when);
    /// A frame that obeys `move`, and so all before it, is on the screen.
    void shown(std::uint64_t move, int width, int height, bool full_size, Time when);
    /// Every move so far has been shown at full size.
    bool all_shown() const { return waiting_.empty(); }
    /// Medians and 95th percentiles, one line; empty without moves.
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
