// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "render/error_watch.h"
#include "report/reporter.h"

namespace fathom::cli {

/// Renders samples into a film, and reports progress.
class Rendering {
public:
    /// time_s  limit from the program's start on; none: all samples are rendered
    /// cancel  rendering stops soon after it becomes true
    Rendering(const RenderJob& job, std::optional<double> time_s, ErrorWatch& watch, const std::atomic<bool>& cancel,
              Reporter& reporter);

    /// Renders the samples of `wanted` that the film does not have yet, until the time is up or the error small enough.
    ///
    /// after_pass  called between passes
    void run(Film& film, SampleRange wanted, std::function<void(const Film&)> after_pass);

    double render_s = 0;
    RenderCosts costs;
    bool was_interrupted = false;
    bool was_time_up = false;
    /// Why rendering ended, unless the error was small enough.
    const char* end() const;

private:
    /// Number of samples to render next, of at most `most`; 0: the time is up.
    std::uint64_t next_count(const Film& film, std::uint64_t most) const;
    void render_range(Film& film, SampleRange range);
    void report(const Progress& p, bool force = false);
    /// Fraction of the render that is done, as far as is known.
    double fraction_done(std::uint64_t samples_done, double now_s) const;

    const RenderJob& job_;
    std::optional<double> time_s_;
    ErrorWatch& watch_;
    const std::atomic<bool>& cancel_;
    Reporter& reporter_;
    std::function<void(const Film&)> after_pass_;
    double start_s_;
    double sample_s_ = 0;         ///< seconds per sample of the latest range; 0: nothing was rendered yet
    std::uint64_t total_ = 0;     ///< samples per pixel of the whole run, at most
    std::uint64_t before_ = 0;    ///< samples per pixel that the film had before
    std::uint64_t rendered_ = 0;  ///< samples per pixel of finished ranges
    std::uint64_t pixels_ = 0, done_ = 0;
};

}  // namespace fathom::cli
