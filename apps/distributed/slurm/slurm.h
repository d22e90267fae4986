// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "distributed/slurm/job_plan.h"

/// Access to Slurm through its commands: every version has them, and a cluster's settings and wrappers stay in force.
/// Functions throw Error with the message of a command that fails.
namespace fathom::cli::slurm {

/// Throws Error if Slurm's commands are missing or its controller doesn't answer.
void check_availability();

/// Largest number of a task in an array.
std::uint64_t max_task_number();

/// Tests on a node, with a task of a few seconds, whether paths are readable. Returns those that are not; nothing if no
/// node was free.
std::optional<std::vector<std::string>> paths_missing_on_nodes(const std::vector<std::string>& paths,
                                                               const std::vector<std::string>& scheduler_options);

/// Submits a script; returns the job number.
std::string submit(const std::string& script, const std::string& folder);

/// A task that has not ended yet.
struct Task {
    bool is_running = false;
    std::string id;     ///< job number for Slurm's commands
    std::string state;  ///< Slurm's name of the state
    /// Slurm could not start the task and holds it until a user acts.
    bool is_stuck = false;
    bool is_held = false;  ///< a user holds it until it is released
    std::string node;      ///< empty until it runs
};
struct Queue {
    std::map<std::uint64_t, Task> parts;
    std::optional<Task> merge;
};
/// Tasks of a plan that have not ended; nothing if the controller doesn't answer.
std::optional<Queue> queue_of(const JobPlan& plan);

void cancel(const std::string& job);

/// Name of the jobs of a plan.
std::string job_name(const JobPlan& plan);
/// Script of an array with a task for each of the parts.
///
/// warning_s  how long before its time limit a task gets a signal, in seconds
std::string task_script(const JobPlan& plan, const std::vector<std::uint64_t>& parts, int warning_s);
/// Script that merges the existing parts after the arrays have ended.
///
/// array  job numbers, separated by colons; empty: the merge waits for nothing
std::string merge_script(const JobPlan& plan, const std::string& array);
/// Warning time that fits the time limit in options for sbatch, in seconds.
int warning_before(const std::vector<std::string>& scheduler_options);

}  // namespace fathom::cli::slurm
