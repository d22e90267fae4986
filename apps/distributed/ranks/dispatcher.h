#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "fathom/render.h"

namespace fathom::cli {

/// Hands the samples of a picture out to ranks, range by range: much at first, less towards the end, and more to fast
/// ranks, so that all end about together and few questions are asked.
class Dispatcher {
public:
    /// end_s  when all are to have ended, on the clock of `next`; none: when all samples are there
    /// nothing_yet  the first range is handed out however late it is
    Dispatcher(std::vector<SampleRange> samples, int ranks, std::optional<double> end_s, bool nothing_yet);

    /// What a rank is to render next; nothing: it is done.
    ///
    /// sample_s  what a sample of all pixels has taken it, last; 0: not known yet
    std::optional<SampleRange> next(int rank, double sample_s, double now_s);

private:
    struct Rank {
        double per_s = 0;        ///< samples; 0: not known yet
        std::uint64_t last = 0;  ///< samples of its last range
    };

    double speed_of(const Rank& rank) const;
    /// Whether the others would be done with all that is left before this rank had a single sample.
    bool is_too_slow(std::size_t rank) const;

    std::vector<SampleRange> todo_;  ///< last ones first
    std::uint64_t left_;
    std::vector<Rank> ranks_;
    std::optional<double> end_s_;
    bool nothing_yet_;
};

}  // namespace fathom::cli
