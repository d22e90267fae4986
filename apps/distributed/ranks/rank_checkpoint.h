#pragma once
#include <limits>
#include <optional>
#include <string>

#include "distributed/ranks/ranks.h"
#include "render/checkpoint.h"
#include "render/image_writer.h"

namespace fathom::cli {

/// What a rank has rendered itself, and where it keeps that: now and then if there is to be a checkpoint, else only
/// when the run is cut off.
class OwnSamples {
public:
    /// At rank 0 with what earlier runs have left in the checkpoint.
    OwnSamples(const RenderOptions& options, const RenderPlan& plan, const PictureOptions& files, const RenderJob& job,
               const Summary& summary, Reporter& reporter);

    /// Keeps them if it is time to, or `is_wanted`, and there is a checkpoint.
    void keep_now_and_then(const Film& now, bool is_wanted);
    /// Keeps what is not kept yet, and waits until that is written.
    void keep();
    /// What is kept, and how to go on from it.
    std::string kept_text() const;
    /// Writes the film of all as the checkpoint, if there is one; false if that was not possible.
    bool keep_all();
    /// What only this rank has is in the checkpoint or the picture of all: its file goes.
    void remove();

    Film film;
    std::uint64_t samples_before;  ///< from earlier runs

private:
    void write(const Film& now);

    const RenderOptions& o_;
    const RenderPlan& plan_;
    const Summary& summary_;
    PictureWriter states_;
    std::filesystem::path all_, file_;  ///< the checkpoint; this rank's own
    Checkpoint checkpoint_;
    std::uint64_t kept_;  ///< samples that were to be written last
};

}  // namespace fathom::cli
