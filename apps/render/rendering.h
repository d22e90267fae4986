#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "options/render_options.h"
#include "report/reporter.h"

namespace fathom::cli {

/// Renders what the options ask for into one film, and tells how far it is.
class Rendering {
public:
    Rendering(const RenderOptions& options, const RenderJob& job, Reporter& reporter);

    /// The samples of `wanted` that the film does not have yet.
    ///
    /// after_pass  is called between passes
    void run(Film& film, SampleRange wanted, std::function<void(const Film&)> after_pass);

    double render_s = 0;
    RenderCosts costs;
    bool cut_short = false;

private:
    /// total  samples a pixel of the whole job
    void render_range(Film& film, SampleRange range, std::uint64_t total);
    /// Ranges that double, so that their overhead is small, until the next would end too late.
    void render_for_time(Film& film, double time_s, std::vector<SampleRange> todo);
    void report(const Progress& p, std::uint64_t total, bool force = false);

    const RenderOptions& options_;
    const RenderJob& job_;
    Reporter& reporter_;
    std::function<void(const Film&)> after_pass_;
    double start_s_;
    std::uint64_t pixels_ = 0, done_ = 0;
};

}  // namespace fathom::cli
