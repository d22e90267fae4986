// SPDX-License-Identifier: Apache-2.0
#include "distributed/slurm/submission.h"

#include <fmt/format.h>
#include <unistd.h>

#include "commands/commands.h"
#include "distributed/slurm/slurm.h"
#include "fathom/error.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;

/// The plan of an earlier submission of this image, with the scheduler options of this one; else this plan.
JobPlan joined_with_earlier(JobPlan plan)
{
    std::error_code error;
    if (!fs::exists(plan.folder() / "plan.json", error)) return plan;
    JobPlan earlier = JobPlan::read(plan.folder());
    if (const std::string difference = plan.difference(earlier); !difference.empty())
        throw Error(
            plan.folder().string(), "",
            fmt::format("has parts of another image: {}. Choose another -o, or remove that folder", difference));
    plan.submissions = std::move(earlier.submissions);
    return plan;
}

void make_folder(const fs::path& folder)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (error || access(folder.c_str(), W_OK) != 0)
        throw Error(folder.string(), "", "can't be created or written: it holds the parts, where all nodes see them");
}

/// Throws Error if a node can't see what its tasks are going to read.
void check_nodes_see(const JobPlan& plan, Reporter& reporter)
{
    const Reporter::Phase phase(reporter, "look", "asking a node whether it sees the scene");
    const auto missing = slurm::paths_missing_on_nodes({plan.program, plan.scene.string(), plan.folder().string()},
                                                       plan.scheduler_options);
    if (!missing || missing->empty()) return;
    std::error_code error;
    fs::remove(plan.folder(), error);  // fails unless it is empty
    throw Error(missing->front(), "",
                "is not visible on the cluster's nodes: keep scene, program and image in a shared folder "
                "(--unchecked submits anyway)");
}

/// Cancels tasks that Slurm could not start, since new ones take their place.
void cancel_stuck(slurm::Queue& queue)
{
    std::erase_if(queue.parts, [](const auto& part) {
        if (part.second.is_stuck) slurm::cancel(part.second.id);
        return part.second.is_stuck;
    });
    if (queue.merge && queue.merge->is_stuck) {
        slurm::cancel(queue.merge->id);
        queue.merge.reset();
    }
}

/// Incomplete parts that no task is working on.
std::vector<std::uint64_t> parts_to_submit(const JobPlan& plan, const slurm::Queue& queue)
{
    std::vector<std::uint64_t> parts;
    for (std::uint64_t part = 1; part <= plan.parts; ++part) {
        const SampleRange range = plan.samples_of(part);
        if (!queue.parts.contains(part) && read_part(plan, part).samples < range.second - range.first)
            parts.push_back(part);
    }
    return parts;
}

/// Submits a merge of complete parts, unless tasks or a merge are under way.
void submit_merge_alone(JobPlan& plan, const slurm::Queue& queue, Reporter& reporter)
{
    reporter.note(queue.parts.empty() ? "all parts are complete" : "all parts are complete or under way");
    if (!queue.parts.empty() || queue.merge) return;
    plan.submissions.push_back({"", slurm::submit(slurm::merge_script(plan, ""), plan.folder().string())});
    plan.write();
    reporter.note(
        fmt::format("submitted job {}: merge to {}", plan.submissions.back().merge, plan.outputs.front().string()));
}

/// Submits tasks for these parts, and replaces a waiting merge by one that also waits for them.
void submit_parts(JobPlan& plan, const slurm::Queue& queue, const std::vector<std::uint64_t>& parts, Reporter& reporter)
{
    Submission submission;
    const std::string folder = plan.folder().string();
    submission.array =
        slurm::submit(slurm::task_script(plan, parts, slurm::warning_before(plan.scheduler_options)), folder);
    // The plan is written before anything else can fail: unrecorded tasks would be submitted twice.
    plan.submissions.push_back(submission);
    plan.write();
    if (queue.merge)
        for (const Submission& s : plan.submissions)
            if (!s.merge.empty()) slurm::cancel(s.merge);
    std::string arrays;
    for (const Submission& s : plan.submissions)
        if (!s.array.empty()) arrays += (arrays.empty() ? "" : ":") + s.array;
    plan.submissions.back().merge = slurm::submit(slurm::merge_script(plan, arrays), folder);
    plan.write();
    const std::string image = plan.outputs.front().string();
    reporter.note(fmt::format("submitted array {}: {} of {} samples per pixel each; job {}: merge to {}",
                              submission.array, parts.size() == 1 ? "1 part" : fmt::format("{} parts", parts.size()),
                              plan.samples / plan.parts, plan.submissions.back().merge, image));
    reporter.note(fmt::format("`fathom status {}` reports their progress", image));
}

}  // namespace

std::string submission_scripts(const JobPlan& plan)
{
    std::vector<std::uint64_t> all;
    for (std::uint64_t part = 1; part <= plan.parts; ++part) all.push_back(part);
    return slurm::task_script(plan, all, slurm::warning_before(plan.scheduler_options)) + "\n" +
           slurm::merge_script(plan, "NUMBER_OF_THE_ARRAY");
}

void submit_job(JobPlan plan, bool is_fix, bool is_checked, Reporter& reporter)
{
    slurm::check_availability();
    if (const std::uint64_t max_tasks = slurm::max_task_number(); plan.parts > max_tasks)
        throw UsageError(fmt::format("--parts: this cluster takes arrays of up to {} tasks (MaxArraySize)", max_tasks));
    if (!is_fix) plan = joined_with_earlier(std::move(plan));
    make_folder(plan.folder());
    // Later tasks read the same files as the first ones.
    if (is_checked && plan.submissions.empty()) check_nodes_see(plan, reporter);
    auto queue = slurm::queue_of(plan);
    if (!queue) throw Error("", "", "Slurm doesn't answer, so running tasks are unknown: nothing was submitted");
    cancel_stuck(*queue);
    const std::vector<std::uint64_t> parts = parts_to_submit(plan, *queue);
    if (parts.empty())
        submit_merge_alone(plan, *queue, reporter);
    else
        submit_parts(plan, *queue, parts, reporter);
}

}  // namespace fathom::cli
