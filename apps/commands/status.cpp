// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "distributed/slurm/job_status.h"
#include "options/command.h"
#include "options/sample_plan.h"
#include "process/streams.h"

namespace fathom::cli {

namespace {

constexpr CommandText status_text{"status", "Report the progress of a submitted image, part by part",
                                  "Example:\n"
                                  "  fathom status out.exr\n\n"
                                  "Exit codes: 0 success; 1 error; 2 wrong usage."};

using nlohmann::ordered_json;

struct StatusOptions {
    std::filesystem::path image;
    bool json = false;
};

std::string time_text(double seconds)
{
    if (seconds < 90) return fmt::format("{:.0f} s", seconds);
    return seconds < 5400 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

std::string task_note(const slurm::Task& task)
{
    if (task.is_stuck) return "Slurm could not start it and holds it";
    if (task.is_held) return fmt::format("held by a user: scontrol release {}", task.id);
    return task.node;
}

void print_parts(const JobStatus& status)
{
    write_stdout(fmt::format("{:>5}  {:<8} {:>9} {:>9}  {}\n", "part", "state", "samples", "of", "node"));
    for (const PartStatus& part : status.parts) {
        std::string note = task_note(part.task);
        if (!part.film.error.empty()) note += (note.empty() ? "" : ": ") + part.film.error;
        write_stdout(fmt::format("{:>5}  {:<8} {:>9} {:>9}  {}\n", part.number, name_of(part.state), part.film.samples,
                                 part.wanted, note));
    }
}

void print_total(const JobPlan& plan, const JobStatus& status)
{
    std::string total = fmt::format("{} of {} samples per pixel ({:.0f} %)", status.samples, plan.samples,
                                    100 * double(status.samples) / double(plan.samples));
    if (status.noise > 0) total += fmt::format(", noise {:.2g} % of the mean", 100 * status.noise);
    if (status.left_s) total += fmt::format("; about {} left", time_text(*status.left_s));
    write_stdout(total + "\n");
}

/// Prints what is missing, and which command helps.
void print_next_step(const std::string& image, const JobPlan& plan, const JobStatus& status)
{
    if (!status.scheduler_answers) write_stdout("Slurm doesn't answer: running and waiting tasks are unknown\n");
    const auto lost = parts_in_state(status, {PartState::missing, PartState::damaged});
    if (!lost.empty() && status.scheduler_answers)
        write_stdout(fmt::format("no job is working on {} {}: fathom submit --fix {}\n",
                                 lost.size() == 1 ? "part" : "parts", number_ranges_text(lost), image));
    if (status.merged) {
        write_stdout(fmt::format("{} has {} of the samples\n", image, count_samples(*status.merged)));
    } else if (status.merge_waits) {
        write_stdout(status.merge.is_held
                         ? fmt::format("the job that merges the parts is {}\n", task_note(status.merge))
                         : "the parts are merged when all tasks have ended\n");
    } else if (lost.empty() && status.scheduler_answers && status.samples == plan.samples) {
        write_stdout(
            fmt::format("the image does not exist, and no job will merge it: fathom submit --fix {}\n", image));
    }
}

void print_text(const JobPlan& plan, const JobStatus& status)
{
    const std::string image = plan.outputs.front().string();
    write_stdout(fmt::format("{}: {} samples per pixel in {} parts\n", image, plan.samples, plan.parts));
    print_parts(status);
    print_total(plan, status);
    print_next_step(image, plan, status);
}

ordered_json to_json(const JobPlan& plan, const JobStatus& status)
{
    ordered_json json{{"image", plan.outputs.front().string()}, {"samples_per_pixel", plan.samples},
                      {"samples_done", status.samples},         {"scheduler_answers", status.scheduler_answers},
                      {"merge_waits", status.merge_waits},      {"merged", status.merged.has_value()}};
    if (status.noise > 0) json["noise"] = status.noise;
    if (status.left_s) json["left_s"] = *status.left_s;
    json["parts"] = ordered_json::array();
    for (const PartStatus& part : status.parts) {
        ordered_json p{
            {"part", part.number}, {"state", name_of(part.state)}, {"samples", part.film.samples}, {"of", part.wanted}};
        if (!part.task.node.empty()) p["node"] = part.task.node;
        if (part.task.is_held) p["held"] = true;
        if (!part.film.error.empty()) p["trouble"] = part.film.error;
        json["parts"].push_back(p);
    }
    return json;
}

int run_status(const StatusOptions& o)
{
    const JobPlan plan = JobPlan::read(JobPlan::folder_of(o.image));
    const JobStatus status = read_job_status(plan);
    if (o.json)
        write_stdout(to_json(plan, status).dump(1) + "\n");
    else
        print_text(plan, status);
    return exit_ok;
}

void add_options(Command& command, StatusOptions& o)
{
    command.add_positional("IMAGE", o.image, "the image that `fathom submit` got as -o");
    add_json_option(command, o.json);
}

}  // namespace

void add_status(CLI::App& program, Run& run)
{
    add_command<StatusOptions>(program, run, status_text, add_options, run_status);
}

}  // namespace fathom::cli
