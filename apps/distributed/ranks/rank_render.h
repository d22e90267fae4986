#pragma once
#include <optional>
#include <string>
#include <type_traits>

#include "distributed/ranks/rank_checkpoint.h"
#include "distributed/ranks/ranks.h"
#include "fathom/costs.h"
#include "render/still.h"

namespace fathom::cli {

/// How far a rank is, as it tells rank 0.
struct RankReport {
    std::uint64_t done = 0;  ///< samples of pixels
    RenderCosts costs;

    std::string bytes() const;
    /// The inverse.
    static RankReport of(const std::string& bytes);
    RankReport& operator+=(const RankReport& o);
};
static_assert(std::is_trivially_copyable_v<RankReport>);

/// What all ranks do alike for a picture: render the ranges that they get, and keep what they have.
class SharedPicture {
public:
    SharedPicture(const RenderOptions& options, const RenderPlan& plan, const PictureOptions& files,
                  const RenderJob& job, const Summary& summary, Reporter& reporter);
    virtual ~SharedPicture() = default;
    SharedPicture(const SharedPicture&) = delete;
    SharedPicture& operator=(const SharedPicture&) = delete;

    /// Returns the exit code.
    virtual int run() = 0;

protected:
    /// How long another rank may not answer once the run has been interrupted: while it may be rendering, and when it
    /// has said that it is done.
    static constexpr double impatience_s = 0.2, patience_s = 10;

    /// What to render next; sample_s: what a sample of all pixels took last.
    virtual std::optional<SampleRange> next(double sample_s) = 0;
    /// Between passes, `own_.film` being as it is to be told of.
    virtual void after_pass(const RankReport& now) = 0;

    /// Renders, and keeps what there is whatever happens.
    void render_and_keep();

    const RenderOptions& o_;
    const RenderPlan& plan_;
    Ranks& ranks_;
    const RenderJob& job_;
    OwnSamples own_;
    RankReport report_;
    double start_s_;
    std::uint64_t pixels_ = 0;

private:
    void learn();
    void render_ranges();
    void render_range(SampleRange range);
};

}  // namespace fathom::cli
