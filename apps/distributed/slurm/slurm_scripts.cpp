// SPDX-License-Identifier: Apache-2.0
/// The scripts that Slurm runs. bash runs a trap only after its foreground program has ended, so the render is a
/// background child. An array's number means all of its tasks. A cancelled task gets the same signals as a preempted
/// one, but must not requeue itself.
#include <fmt/format.h>
#include <algorithm>
#include <cctype>

#include "distributed/slurm/slurm.h"
#include "options/arguments.h"

namespace fathom::cli::slurm {

namespace {

/// Quotes a text as one word of a shell.
std::string quoted(const std::string& word)
{
    const auto is_plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) ||
               std::string_view("_-./:=,+@%").find(c) != std::string::npos;
    };
    if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
    std::string text = "'";
    for (char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

std::string quoted(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : " ") + quoted(word);
    return text;
}

/// Option lines for sbatch.
std::string directives(const std::vector<std::string>& words)
{
    std::string text;
    for (const std::string& word : words) text += "#SBATCH " + quoted(word) + "\n";
    return text;
}
/// Escapes '%', which starts a pattern in the name of a log file.
std::string escape_pattern(std::string path)
{
    for (std::size_t at = 0; (at = path.find('%', at)) != std::string::npos; at += 2) path.insert(at, "%");
    return path;
}

/// Replaces each @name@ once, in the order of `values`.
std::string fill_template(std::string text, const std::vector<std::pair<std::string, std::string>>& values)
{
    std::size_t at = 0;
    for (const auto& [name, value] : values) {
        at = text.find(name, at);
        text.replace(at, name.size(), value);
        at += value.size();
    }
    return text;
}

/// Seconds of a time in Slurm's notation: M, M:S, H:M:S, D-H, D-H:M, D-H:M:S; 0 for other texts.
double parse_slurm_time(const std::string& text)
{
    const std::size_t dash = text.find('-');
    const std::vector<std::string> parts = split(dash == std::string::npos ? text : text.substr(dash + 1), ':');
    double number[3] = {};
    for (std::size_t i = 0; i < parts.size() && i < 3; ++i) number[i] = std::strtod(parts[i].c_str(), nullptr);
    if (dash != std::string::npos)
        return std::strtod(text.c_str(), nullptr) * 86400 + number[0] * 3600 + number[1] * 60 + number[2];
    if (parts.size() == 3) return number[0] * 3600 + number[1] * 60 + number[2];
    return number[0] * 60 + number[1];
}

/// Passes the job's memory limit to fathom, which keeps it even if the cluster does not enforce it.
constexpr const char job_memory[] =
    R"([ "${SLURM_MEM_PER_NODE:-0}" -gt 0 ] && memory=(--memory "${SLURM_MEM_PER_NODE}Mi"))";

}  // namespace

std::string job_name(const JobPlan& plan)
{
    std::string name = "fathom-" + plan.outputs.front().filename().string();
    // squeue takes names as a list with commas.
    for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '_') c = '_';
    return name;
}

int warning_before(const std::vector<std::string>& scheduler_options)
{
    constexpr int max_s = 120, min_s = 10;
    for (const std::string& word : scheduler_options)
        if (word.starts_with("--time="))
            if (const double s = parse_slurm_time(word.substr(7)); s > 0) return std::clamp(int(s / 10), min_s, max_s);
    return max_s;
}

std::string task_script(const JobPlan& plan, const std::vector<std::uint64_t>& parts, int warning_s)
{
    const std::string folder = plan.folder().string();
    std::vector<std::string> options = {"--job-name=" + job_name(plan),
                                        "--array=" + number_ranges_text(parts),
                                        "--output=" + escape_pattern(folder) + "/part-%4a.log",
                                        "--open-mode=append",
                                        "--requeue",
                                        fmt::format("--signal=B:USR1@{}", warning_s)};
    options.insert(options.end(), plan.scheduler_options.begin(), plan.scheduler_options.end());
    std::vector<std::string> render = {plan.program, "render", plan.scene.string()};
    render.insert(render.end(), plan.render_options.begin(), plan.render_options.end());
    const bool has_memory_option = std::find(render.begin(), render.end(), "--memory") != render.end();
    return fill_template(R"script(#!/bin/bash
# Renders one part of an image. Written by `fathom submit`.
@directives@
film=@folder@/part-$(printf %04d "$SLURM_ARRAY_TASK_ID").exr
# The array's number alone would mean all of its tasks.
task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
seen() { stat -c '%i %s %Y' "$film" 2>/dev/null; }

# At the time limit, or when the node is needed for another job, saves the samples and requeues the task. A task that was
# cancelled is not running any more and stays away; so does one that has rendered nothing in its time.
end_turn() {
    trap '' TERM USR1
    kill -TERM "$render" 2>/dev/null
    wait "$render" && exit 0
    if [ "$(seen)" = "$before" ]; then
        echo "fathom: the time limit was too short for one sample: give tasks more time (--time)"
        exit 1
    fi
    [ "$(squeue --noheader --jobs="$task" --format=%T 2>/dev/null)" = RUNNING ] && scontrol requeue "$task"
    exit 0
}

memory=()
@memory@
before=$(seen)
trap end_turn TERM USR1
@render@ "${memory[@]}" --spp @samples@ --part "$SLURM_ARRAY_TASK_ID/@parts@" --checkpoint "$film" &
render=$!
wait "$render"
)script",
                         {{"@directives@", directives(options)},
                          {"@folder@", quoted(folder)},
                          {"@memory@", has_memory_option ? "" : job_memory},
                          {"@render@", quoted(render)},
                          {"@samples@", fmt::format("{}", plan.samples)},
                          {"@parts@", fmt::format("{}", plan.parts)}});
}

std::string merge_script(const JobPlan& plan, const std::string& array)
{
    const std::string folder = plan.folder().string();
    // afterany, so that the other parts are merged even if a task fails.
    std::vector<std::string> options = {"--job-name=" + job_name(plan),
                                        "--output=" + escape_pattern(folder) + "/merge.log", "--open-mode=append",
                                        "--requeue"};
    if (!array.empty()) options.push_back("--dependency=afterany:" + array);
    for (const std::string& word : plan.scheduler_options)
        if (!word.starts_with("--cpus-per-task")) options.push_back(word);
    std::vector<std::string> merge = plan.merge_options;
    for (const auto& output : plan.outputs) merge.insert(merge.end(), {"-o", output.string()});
    return fill_template(R"script(#!/bin/bash
# Merges all existing parts of an image. Written by `fathom submit`.
@directives@
exec @program@ merge @folder@/part-*[0-9].exr @options@
)script",
                         {{"@directives@", directives(options)},
                          {"@program@", quoted(plan.program)},
                          {"@folder@", quoted(folder)},
                          {"@options@", quoted(merge)}});
}

}  // namespace fathom::cli::slurm
