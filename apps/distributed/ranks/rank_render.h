// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <type_traits>

#include "distributed/ranks/rank_checkpoint.h"
#include "distributed/ranks/ranks.h"
#include "fathom/costs.h"
#include "render/still.h"

namespace fathom::cli {

/// Progress of a rank, sent to rank 0.
struct RankReport {
    std::uint64_t done = 0;  ///< pixels times samples
    RenderCosts costs;

    std::string to_bytes() const;
    static RankReport from_bytes(const std::string& bytes);
    RankReport& operator+=(const RankReport& o);
};
static_assert(std::is_trivially_copyable_v<RankReport>);

/// An image at one rank: renders the ranges that rank 0 hands out, and saves its samples.
class RankRender {
public:
    RankRender(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job, const Summary& summary,
               Reporter& reporter);
    virtual ~RankRender() = default;
    RankRender(const RankRender&) = delete;
    RankRender& operator=(const RankRender&) = delete;

    /// Returns the exit code.
    virtual int run() = 0;

protected:
    /// Limits on the silence of another rank after an interrupt: while it may be rendering, and once it is done.
    static constexpr double impatience_s = 0.2, patience_s = 10;

    /// The range to render next; nothing: this rank is done.
    ///
    /// sample_s  time that the last sample of all pixels took
    virtual std::optional<SampleRange> next_range(double sample_s) = 0;
    /// Called between passes, with a consistent film.
    virtual void after_pass(const RankReport& now) = 0;

    /// Renders, and saves the samples even if rendering throws.
    void render_and_save();

    const RenderPlan& plan_;
    Ranks& ranks_;
    const RenderJob& job_;
    RankCheckpoint own_;
    RankReport report_;
    double start_s_;
    std::uint64_t pixels_ = 0;

private:
    void train_guiding();
    void render_ranges();
    void render_range(SampleRange range);
};

}  // namespace fathom::cli
