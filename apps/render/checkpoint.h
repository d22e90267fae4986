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
#include "report/reporter.h"

namespace fathom::cli {

/// Where a checkpoint keeps scene_parts.
inline constexpr const char* parts_attribute = "fathom.scene_parts";

/// Between states, unless another time is asked for.
inline constexpr double default_every_s = 60;

/// Where a rank keeps its own samples beside the checkpoint of all: `a.rank3.exr` beside `a.exr`, which rank 0 writes.
std::filesystem::path rank_file(const std::filesystem::path& checkpoint, int rank);
/// Removes a state and the one before it, if they are there.
void remove_states(const std::filesystem::path& file);

/// Where the generation before the last is kept: `a.previous.exr` beside `a.exr`.
std::filesystem::path previous_of(const std::filesystem::path& file);

/// The film of a render on the disk, so that the render can be cut off at any moment: the last state and the one
/// before.
///
/// A state is copied in memory, which is all that rendering waits for, and written by a thread of its own. What can't
/// be written is told once, and tried again; the render goes on.
class Checkpoint {
public:
    Checkpoint(std::filesystem::path file, double every_s, Reporter& reporter);
    Checkpoint(const Checkpoint&) = delete;
    Checkpoint& operator=(const Checkpoint&) = delete;
    ~Checkpoint();

    /// The samples that an earlier run of this job has left, or none, with those that its ranks have left beside it
    /// (rank_file), whose files go as soon as a state that has them all is written. Where the last state is damaged the
    /// one before is taken, and told. Throws Error if the file is no film file, is of another scene or other settings,
    /// is damaged altogether, or has samples outside of `wanted`.
    ///
    /// parts  scene_parts of the scene
    Film open(const RenderJob& job, SampleRange wanted, const std::string& parts);
    /// Whether files of ranks are to go.
    bool has_rank_files() const { return !rank_files_.empty(); }
    /// Whether the next state is to be written, and the last one has been.
    bool is_due();
    void write(const Film& film, bool alpha, const std::map<std::string, std::string>& attributes);
    /// Waits until the last state has been written; false if it could not be.
    bool finish();

private:
    /// Tells what has become of the last attempt. Not while one is under way.
    void tell_outcome();
    void run();
    Film open_own(const RenderJob& job, SampleRange wanted, const std::string& parts);
    void add_rank_file(const std::filesystem::path& file, Film& film, SampleRange wanted, const std::string& parts);

    std::filesystem::path file_;
    std::filesystem::path opened_;                   ///< which of the two states was taken
    std::vector<std::filesystem::path> rank_files_;  ///< whose samples the film has that is being rendered
    double every_s_, next_s_;
    Reporter& reporter_;
    FilmSnapshot snapshot_;
    std::string failure_, told_failure_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool to_write_ = false, end_ = false;
    std::thread thread_;
};

}  // namespace fathom::cli
