// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "fathom/render.h"

namespace fathom::cli {

/// Hands out the samples of an image to ranks, range by range. Ranges shrink towards the end and are longer for fast
/// ranks, so that all ranks finish at about the same time after few requests.
class Dispatcher {
public:
    /// end_s        time limit on the clock of `next`; none: all samples are handed out
    /// nothing_yet  no sample exists yet, so the first range is handed out however late it is
    Dispatcher(std::vector<SampleRange> samples, int ranks, std::optional<double> end_s, bool nothing_yet);

    /// The range that a rank renders next; nothing: the rank is done.
    ///
    /// sample_s  time that the rank's last sample of all pixels took; 0: unknown
    std::optional<SampleRange> next(int rank, double sample_s, double now_s);

private:
    struct Rank {
        double per_s = 0;        ///< samples per second; 0: unknown
        std::uint64_t last = 0;  ///< number of samples in its last range
    };

    double speed_of(const Rank& rank) const;
    /// Whether the other ranks would finish everything before this one finished a single sample.
    bool is_too_slow(std::size_t rank) const;

    std::vector<SampleRange> todo_;  ///< in reverse order
    std::uint64_t left_;
    std::vector<Rank> ranks_;
    std::optional<double> end_s_;
    bool nothing_yet_;
};

}  // namespace fathom::cli
