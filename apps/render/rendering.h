#pragma once
#include <optional>

#include "../reporter.h"
#include "options.h"

namespace fathom::cli {

/// Renders what the options ask for into one film, and tells how far it is.
class Rendering {
public:
    Rendering(const RenderOptions& options, const RenderJob& job, Reporter& reporter);

    void run(Film& film, std::optional<std::uint64_t> samples);

    double render_s = 0;
    RenderCosts costs;
    bool cut_short = false;

private:
    /// total  samples a pixel of the whole job
    void render_range(Film& film, SampleRange range, std::uint64_t total);
    /// Ranges that double, so that their overhead is small, until the next would end too late.
    void render_for_time(Film& film, double time_s, std::uint64_t most);
    void report(const Progress& p, std::uint64_t total, bool force = false);

    const RenderOptions& options_;
    const RenderJob& job_;
    Reporter& reporter_;
    double start_s_;
    std::uint64_t pixels_ = 0, done_ = 0;
};

}  // namespace fathom::cli
