// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <limits>
#include <optional>
#include <string>

#include "distributed/ranks/ranks.h"
#include "render/checkpoint.h"
#include "render/image_writer.h"

namespace fathom::cli {

/// The film of one rank and its file: with --checkpoint it is written regularly, else only when the run is cut off.
class RankCheckpoint {
public:
    /// At rank 0, the film starts with the samples of an existing checkpoint.
    RankCheckpoint(const RenderPlan& plan, const ImageOptions& files, const RenderJob& job, const Summary& summary,
                   Reporter& reporter);

    /// With --checkpoint, starts a write if the interval is over or `is_requested`.
    void save_if_due(const Film& now, bool is_requested);
    /// Writes samples that are not in the file yet, and waits for that.
    void save();
    /// Tells where the samples are, and how to continue from them.
    std::string resume_hint() const;
    /// With --checkpoint, writes the merged film of all ranks; false if that failed.
    bool save_merged();
    /// Removes this rank's file, once the checkpoint or the image has its samples.
    void remove();

    Film film;
    std::uint64_t samples_before;  ///< from earlier runs

private:
    void write(const Film& now);

    const RenderPlan& plan_;
    const Summary& summary_;
    ImageWriter images_;
    std::filesystem::path merged_file_, file_;  ///< the checkpoint, and this rank's own
    Checkpoint checkpoint_;
    std::uint64_t saved_samples_;  ///< samples per pixel of the last write
};

}  // namespace fathom::cli
