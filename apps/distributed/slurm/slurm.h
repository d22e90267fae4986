#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "distributed/slurm/job_plan.h"

/// What is asked of Slurm, by its own commands: every version has them, and a cluster's own settings and wrappers stay
/// in force. Throws Error with what they said where one fails.
namespace fathom::cli::slurm {

/// Throws Error if its commands are not here, or its controller doesn't answer.
void check_is_here();

/// The largest number that a task of an array may have here.
std::uint64_t largest_task_number();

/// Whether files can be read, and a folder and programs be used, on a node, which a task of a few seconds finds out.
/// Returns those that can't; nothing where no node was free to look.
std::optional<std::vector<std::string>> paths_missing_on_nodes(const std::vector<std::string>& paths,
                                                               const std::vector<std::string>& scheduler_options);

/// Hands a script over; returns the job's number.
std::string submit(const std::string& script, const std::string& folder);

/// A task that has not ended.
struct Task {
    bool is_running = false;
    std::string id;     ///< as Slurm's commands take it
    std::string state;  ///< as Slurm calls it
    /// Slurm could not start it and holds it back: it waits for ever if nobody does anything.
    bool is_stuck = false;
    bool is_held = false;  ///< somebody wants it to wait until it is released
    std::string node;      ///< empty until it runs
};
struct Queue {
    std::map<std::uint64_t, Task> parts;
    std::optional<Task> merge;
};
/// What of a plan's tasks has not ended; nothing where the controller doesn't answer.
std::optional<Queue> queue_of(const JobPlan& plan);

void cancel(const std::string& job);

/// The name of a plan's jobs.
std::string job_name(const JobPlan& plan);
/// The script of a task of an array, one for each of the parts. warning_s: that long before its time is up a task is
/// told.
std::string task_script(const JobPlan& plan, const std::vector<std::uint64_t>& parts, int warning_s);
/// The script that merges what is there, when the array has ended.
std::string merge_script(const JobPlan& plan, const std::string& array);
/// How long before the time limit among sbatch's words tasks had better be told, in seconds.
int warning_before(const std::vector<std::string>& scheduler_options);

}  // namespace fathom::cli::slurm
