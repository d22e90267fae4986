// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "fathom/film_file.h"
#include "options/render_options.h"
#include "report/reporter.h"

namespace fathom::cli {

/// Attribute of checkpoints that holds scene_digest.
inline constexpr const char* parts_attribute = "fathom.scene_parts";

/// The file of a rank's own samples: `a.rank3.exr` beside the checkpoint `a.exr`, which rank 0 writes.
std::filesystem::path rank_file(const std::filesystem::path& checkpoint, int rank);
/// Removes a checkpoint and its previous generation, if they exist.
void remove_generations(const std::filesystem::path& file);

/// The file of the previous generation: `a.previous.exr` beside `a.exr`.
std::filesystem::path previous_file(const std::filesystem::path& file);

/// The film of a render on disk, in two generations, so that the render can be cut off at any moment.
///
/// Rendering only waits while the film is copied in memory; a thread writes the copy. A failed write is reported once
/// and tried again; the render goes on.
class Checkpoint {
public:
    Checkpoint(const CheckpointOptions& options, Reporter& reporter);
    Checkpoint(const Checkpoint&) = delete;
    Checkpoint& operator=(const Checkpoint&) = delete;
    ~Checkpoint();

    /// The film of an earlier run, or an empty one, merged with what its ranks left in files beside it (rank_file),
    /// which are removed once a checkpoint holds their samples. If the last generation is damaged, this is reported and
    /// the previous one is used. Throws Error if the file is no film file, is of another render, is damaged in both
    /// generations, or has samples outside of `wanted`.
    ///
    /// parts  scene_digest of the scene
    Film open(const RenderJob& job, SampleRange wanted, const std::string& parts);
    /// Whether files of ranks were merged, and are still to be removed.
    bool has_rank_files() const { return !rank_files_.empty(); }
    /// Whether the interval is over and no write is under way.
    bool is_due();
    void write(const Film& film, bool alpha, const std::map<std::string, std::string>& attributes);
    /// Waits until the last write has ended; false if it failed.
    bool finish();

private:
    /// Reports the last write if its outcome differs from the one before. Must not be called while a write is under
    /// way.
    void report_outcome();
    void write_in_background();
    Film open_own(const RenderJob& job, SampleRange wanted, const std::string& parts);
    void add_rank_file(const std::filesystem::path& file, Film& film, SampleRange wanted, const std::string& parts);

    std::filesystem::path file_;
    std::filesystem::path opened_;                   ///< the generation that was used
    std::vector<std::filesystem::path> rank_files_;  ///< merged into the film
    double every_s_, next_s_;
    Reporter& reporter_;
    FilmSnapshot snapshot_;
    std::string failure_, reported_failure_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool to_write_ = false, end_ = false;
    std::thread thread_;
};

}  // namespace fathom::cli
