#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "distributed/slurm/job_plan.h"
#include "distributed/slurm/slurm.h"
#include "fathom/error.h"
#include "fathom/film_file.h"
#include "options/arguments.h"
#include "options/sample_plan.h"
#include "process/streams.h"

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

struct StatusOptions {
    std::filesystem::path picture;
    bool json = false;
};

/// Words for where a part is.
enum class PartState { done, running, waiting, missing, damaged };
const char* name_of(PartState state)
{
    constexpr const char* names[] = {"done", "running", "waiting", "missing", "damaged"};
    return names[int(state)];
}

struct PartStatus {
    std::uint64_t number = 0, wanted = 0;
    PartState state = PartState::missing;
    PartFilm film;
    slurm::Task task;
};

struct JobStatus {
    std::vector<PartStatus> parts;
    std::uint64_t samples = 0;
    double noise = 0;              ///< of the mean of all parts so far, about; 0: not known
    std::optional<double> left_s;  ///< nothing where that can't be told
    bool merge_waits = false, answers = true;
    slurm::Task merge;                               ///< if it waits
    std::optional<std::vector<SampleRange>> merged;  ///< what the picture has, if it is there
};

PartStatus status_of(const JobPlan& plan, std::uint64_t number, const std::optional<slurm::Queue>& queue)
{
    PartStatus part;
    const SampleRange range = plan.samples_of(number);
    part.number = number;
    part.wanted = range.second - range.first;
    part.film = look_at_part(plan, number);
    if (queue)
        if (const auto task = queue->parts.find(number); task != queue->parts.end()) part.task = task->second;
    if (part.film.samples >= part.wanted)
        part.state = PartState::done;
    else if (!part.task.state.empty() && !part.task.is_stuck)
        part.state = part.task.is_running ? PartState::running : PartState::waiting;
    else if (!part.film.trouble.empty())
        part.state = PartState::damaged;
    return part;
}

/// Pictures of parts are averaged by their samples; noise goes by the square root of them.
double noise_of(const std::vector<PartStatus>& parts, std::uint64_t samples)
{
    double variance = 0;
    for (const PartStatus& part : parts) {
        if (part.film.samples > 0 && part.film.noise == 0) return 0;
        const double share = samples > 0 ? double(part.film.samples) / double(samples) : 0;
        variance += share * share * part.film.noise * part.film.noise;
    }
    return std::sqrt(variance);
}

/// How long until all parts are done that run or wait, if as many run at once as do now.
std::optional<double> time_left(const std::vector<PartStatus>& parts)
{
    double rate = 0, to_do = 0, longest = 0;
    int rates = 0, running = 0;
    for (const PartStatus& part : parts) {
        if (part.film.samples_per_s > 0) rate += part.film.samples_per_s, ++rates;
        running += part.state == PartState::running;
    }
    if (rates == 0 || running == 0) return {};
    rate /= rates;
    for (const PartStatus& part : parts) {
        if (part.state != PartState::running && part.state != PartState::waiting) continue;
        const double left = double(part.wanted - part.film.samples);
        to_do += left;
        if (part.state == PartState::running) longest = std::max(longest, left / rate);
    }
    return std::max(longest, to_do / (rate * running));
}

JobStatus status_of(const JobPlan& plan)
{
    JobStatus status;
    std::optional<slurm::Queue> queue;
    try {
        queue = slurm::queue_of(plan);
    } catch (const Error&) {
        // No Slurm here: what the folder holds can be told all the same.
    }
    status.answers = queue.has_value();
    status.merge_waits = queue && queue->merge && !queue->merge->is_stuck;
    if (status.merge_waits) status.merge = *queue->merge;
    for (std::uint64_t number = 1; number <= plan.parts; ++number) {
        status.parts.push_back(status_of(plan, number, queue));
        status.samples += std::min(status.parts.back().film.samples, status.parts.back().wanted);
    }
    status.noise = noise_of(status.parts, status.samples);
    status.left_s = time_left(status.parts);
    try {
        status.merged = FilmFile(plan.outputs.front()).samples();
    } catch (const Error&) {
        // Not there yet, or no EXR.
    }
    return status;
}

std::vector<std::uint64_t> numbers_of(const JobStatus& status, std::initializer_list<PartState> states)
{
    std::vector<std::uint64_t> numbers;
    for (const PartStatus& part : status.parts)
        if (std::find(states.begin(), states.end(), part.state) != states.end()) numbers.push_back(part.number);
    return numbers;
}

std::string time_text(double seconds)
{
    if (seconds < 90) return fmt::format("{:.0f} s", seconds);
    return seconds < 5400 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

std::string note_on(const slurm::Task& task)
{
    if (task.is_stuck) return "Slurm could not start it, and holds it back";
    if (task.is_held) return fmt::format("held by somebody: scontrol release {}", task.id);
    return task.node;
}

void print_text(const JobPlan& plan, const JobStatus& status)
{
    const std::string picture = plan.outputs.front().string();
    print(fmt::format("{}: {} samples a pixel in {} parts\n", picture, plan.samples, plan.parts));
    print(fmt::format("{:>5}  {:<8} {:>9} {:>9}  {}\n", "part", "is", "samples", "of", "on"));
    for (const PartStatus& part : status.parts) {
        std::string note = note_on(part.task);
        if (!part.film.trouble.empty()) note += (note.empty() ? "" : ": ") + part.film.trouble;
        print(fmt::format("{:>5}  {:<8} {:>9} {:>9}  {}\n", part.number, name_of(part.state), part.film.samples,
                          part.wanted, note));
    }
    std::string total = fmt::format("{} of {} samples a pixel ({:.0f} %)", status.samples, plan.samples,
                                    100 * double(status.samples) / double(plan.samples));
    if (status.noise > 0) total += fmt::format(", noise {:.2g} % of the mean", 100 * status.noise);
    if (status.left_s) total += fmt::format("; about {} left", time_text(*status.left_s));
    print(total + "\n");
    if (!status.answers) print("Slurm doesn't answer: whether tasks run or wait is not known\n");
    const auto lost = numbers_of(status, {PartState::missing, PartState::damaged});
    if (!lost.empty() && status.answers)
        print(fmt::format("nobody is about to make {} {}: fathom submit --fix {}\n",
                          lost.size() == 1 ? "part" : "parts", text_of_numbers(lost), picture));
    if (status.merged) {
        print(fmt::format("{} has {} of them\n", picture, count_of(*status.merged)));
    } else if (status.merge_waits) {
        print(status.merge.is_held ? fmt::format("the job that merges them is {}\n", note_on(status.merge))
                                   : "they are merged when all tasks have ended\n");
    } else if (lost.empty() && status.answers && status.samples == plan.samples) {
        print(fmt::format("the picture is not there, and no task is about to merge it: fathom submit --fix {}\n",
                          picture));
    }
}

ordered_json json_of(const JobPlan& plan, const JobStatus& status)
{
    ordered_json json{{"picture", plan.outputs.front().string()}, {"samples_per_pixel", plan.samples},
                      {"samples_done", status.samples},           {"scheduler_answers", status.answers},
                      {"merge_waits", status.merge_waits},        {"merged", status.merged.has_value()}};
    if (status.noise > 0) json["noise"] = status.noise;
    if (status.left_s) json["left_s"] = *status.left_s;
    json["parts"] = ordered_json::array();
    for (const PartStatus& part : status.parts) {
        ordered_json p{
            {"part", part.number}, {"state", name_of(part.state)}, {"samples", part.film.samples}, {"of", part.wanted}};
        if (!part.task.node.empty()) p["node"] = part.task.node;
        if (part.task.is_held) p["held"] = true;
        if (!part.film.trouble.empty()) p["trouble"] = part.film.trouble;
        json["parts"].push_back(p);
    }
    return json;
}

int run_status(const StatusOptions& o)
{
    const JobPlan plan = JobPlan::read(JobPlan::folder_of(o.picture));
    const JobStatus status = status_of(plan);
    if (o.json)
        print(json_of(plan, status).dump(1) + "\n");
    else
        print_text(plan, status);
    return exit_ok;
}

}  // namespace

void add_status(CLI::App& program, Run& run)
{
    const auto options = std::make_shared<StatusOptions>();
    Command command(program, "status", "Tell how far the parts of a submitted picture are");
    command.add_positional("PICTURE", options->picture, "what -o of `fathom submit` was");
    command.add_flag("--json", options->json, "as JSON");
    command.set_footer(
        "Example:\n"
        "  fathom status out.exr\n\n"
        "Exit codes: 0 done; 1 error; 2 wrong usage.");
    command.set_run(run, [options] { return run_status(*options); });
}

}  // namespace fathom::cli
