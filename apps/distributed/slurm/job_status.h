// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "distributed/slurm/job_plan.h"
#include "distributed/slurm/slurm.h"

namespace fathom::cli {

enum class PartState { done, running, waiting, missing, damaged };
const char* name_of(PartState state);

struct PartStatus {
    std::uint64_t number = 0, wanted = 0;  ///< part, and its number of samples
    PartState state = PartState::missing;
    PartFilm film;
    slurm::Task task;
};

/// Progress of a submitted image.
struct JobStatus {
    std::vector<PartStatus> parts;
    std::uint64_t samples = 0;
    double noise = 0;              ///< approximate noise of the image so far over its mean; 0: unknown
    std::optional<double> left_s;  ///< estimated time until all tasks end
    bool merge_waits = false, scheduler_answers = true;
    slurm::Task merge;                               ///< valid if merge_waits
    std::optional<std::vector<SampleRange>> merged;  ///< samples of the merged image, if it exists
};

/// Reads the films of all parts, and asks Slurm for its queue.
JobStatus read_job_status(const JobPlan& plan);

/// Numbers of the parts in one of these states.
std::vector<std::uint64_t> parts_in_state(const JobStatus& status, std::initializer_list<PartState> states);

}  // namespace fathom::cli
