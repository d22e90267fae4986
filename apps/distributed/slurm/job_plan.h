#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fathom/render.h"

namespace fathom::cli {

/// Tasks that were handed to the scheduler at once, and the one that merges when they have ended.
struct Submission {
    std::string array, merge;  ///< numbers that the scheduler gave
};

/// A picture that a cluster makes in parts: what all of them have in common. Kept in a folder beside the picture, with
/// the parts, so that whoever comes later can tell what is missing.
struct JobPlan {
    std::string program;                       ///< that renders
    std::filesystem::path scene;               ///< absolute, as all paths here
    std::vector<std::string> render_options;   ///< as `fathom render` takes them, but for what makes a part of it
    std::vector<std::string> picture_options;  ///< as `fathom merge` takes them: how files are written
    std::vector<std::filesystem::path> outputs;
    std::uint64_t parts = 1, samples = 1;
    std::vector<std::string> scheduler_options;  ///< words for sbatch
    std::vector<Submission> submissions;

    /// Where everything about the picture is kept.
    std::filesystem::path folder() const { return folder_of(outputs.front()); }
    static std::filesystem::path folder_of(const std::filesystem::path& picture);
    std::filesystem::path film_of(std::uint64_t part) const;
    SampleRange samples_of(std::uint64_t part) const;

    /// Throws Error if the file is no plan, or can't be read or written.
    static JobPlan read(const std::filesystem::path& folder);
    void write() const;
    /// What keeps two from being plans of one picture, in words ("256 samples a pixel, not 512"); empty if nothing
    /// does.
    std::string difference(const JobPlan& other) const;
};

/// What there is of a part.
struct PartFilm {
    std::uint64_t samples = 0;  ///< of its range that are there
    double noise = 0;           ///< of the part's picture, as its file says; 0: it doesn't
    double samples_per_s = 0;   ///< that the last to render it made; 0: unknown
    std::string trouble;        ///< why the file can't be used; empty if it can, or is not there
};
PartFilm look_at_part(const JobPlan& plan, std::uint64_t part);

/// Numbers as sbatch takes them: "1-4,7".
std::string text_of_numbers(const std::vector<std::uint64_t>& ascending);

}  // namespace fathom::cli
