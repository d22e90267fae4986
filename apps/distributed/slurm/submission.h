// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "distributed/slurm/job_plan.h"
#include "report/reporter.h"

namespace fathom::cli {

/// The two scripts of a plan, for --dry-run.
std::string submission_scripts(const JobPlan& plan);

/// Submits the missing work of an image to Slurm: tasks for the parts that no task is working on, and a job that merges
/// all parts. Throws Error and UsageError.
///
/// is_checked  a node is asked first whether it can read the scene
void submit_job(JobPlan plan, bool is_fix, bool is_checked, Reporter& reporter);

}  // namespace fathom::cli
