// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/render.h"

namespace fathom::cli {

/// An array of tasks, and the job that merges their parts after they have ended.
struct Submission {
    std::string array, merge;  ///< job numbers of the scheduler
};

/// An image that a cluster renders in parts. The plan is a file in a folder beside the image, with the parts, so that
/// `fathom status` and `submit --fix` can tell what is missing.
struct JobPlan {
    std::string program;                      ///< path of fathom
    std::filesystem::path scene;              ///< absolute, as all paths here
    std::vector<std::string> render_options;  ///< for `fathom render`, except those that choose the part
    std::vector<std::string> merge_options;   ///< for `fathom merge`
    std::vector<std::filesystem::path> outputs;
    std::uint64_t parts = 1, samples = 1;
    std::vector<std::string> scheduler_options;  ///< for sbatch
    std::vector<Submission> submissions;

    /// Folder of plan, parts and logs.
    std::filesystem::path folder() const { return folder_of(outputs.front()); }
    static std::filesystem::path folder_of(const std::filesystem::path& image);
    std::filesystem::path film_of(std::uint64_t part) const;
    SampleRange samples_of(std::uint64_t part) const;

    /// Both throw Error if the file can't be read or written, or is no valid plan.
    static JobPlan read(const std::filesystem::path& folder);
    void write() const;
    /// Why two plans can't share their parts, in words ("256 samples per pixel, not 512"); empty if they can.
    std::string difference(const JobPlan& other) const;
};

/// The film of a part so far.
struct PartFilm {
    std::uint64_t samples = 0;  ///< number of samples of its range that it has
    double noise = 0;           ///< noise of the part's image over its mean; 0: unknown
    double samples_per_s = 0;   ///< speed of its last task; 0: unknown
    std::string error;          ///< why the file is unusable; empty if it is usable or missing
};
PartFilm read_part(const JobPlan& plan, std::uint64_t part);

/// Ranges of ascending numbers in the notation of sbatch: "1-4,7".
std::string number_ranges_text(const std::vector<std::uint64_t>& ascending);

}  // namespace fathom::cli
