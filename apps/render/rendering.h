// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "report/reporter.h"

namespace fathom::cli {

/// Renders samples into a film, and reports progress.
class Rendering {
public:
    /// time_s  limit from the program's start on; none: all samples are rendered
    /// cancel  rendering stops soon after it becomes true
    Rendering(const RenderJob& job, std::optional<double> time_s, const std::atomic<bool>& cancel, Reporter& reporter);

    /// Renders the samples of `wanted` that the film does not have yet.
    ///
    /// after_pass  called between passes
    void run(Film& film, SampleRange wanted, std::function<void(const Film&)> after_pass);

    double render_s = 0;
    RenderCosts costs;
    bool was_interrupted = false;

private:
    /// total  samples per pixel of the whole run
    void render_range(Film& film, SampleRange range, std::uint64_t total);
    /// Renders ranges of doubling size, so that their overhead is small, until the next one would end too late.
    void render_for_time(Film& film, double time_s, std::vector<SampleRange> todo);
    void report(const Progress& p, std::uint64_t total, bool force = false);

    const RenderJob& job_;
    std::optional<double> time_s_;
    const std::atomic<bool>& cancel_;
    Reporter& reporter_;
    std::function<void(const Film&)> after_pass_;
    double start_s_;
    std::uint64_t pixels_ = 0, done_ = 0;
};

}  // namespace fathom::cli
