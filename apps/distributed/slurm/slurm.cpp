// SPDX-License-Identifier: Apache-2.0
#include "distributed/slurm/slurm.h"

#include <fmt/format.h>
#include <sstream>

#include "fathom/error.h"
#include "options/arguments.h"
#include "process/subprocess.h"

namespace fathom::cli::slurm {

namespace {

/// First line of a command's error message, without the command's name.
std::string error_message(const ProcessResult& result)
{
    std::string line = result.err.substr(0, result.err.find('\n'));
    const std::size_t colon = line.find(": error: ");
    if (colon != std::string::npos) line = line.substr(colon + 9);
    return line.empty() ? fmt::format("exit code {}", result.exit_code) : line;
}

/// Output of a command. Throws Error if it fails.
std::string run_command(const std::vector<std::string>& words, const std::string& input = "")
{
    const ProcessResult result = run_process(words, input);
    if (result.exit_code != 0) throw Error("", "", fmt::format("Slurm's {}: {}", words.front(), error_message(result)));
    return result.out;
}

bool is_held(const std::string& state, const std::string& reason)
{
    return state == "REQUEUE_HOLD" || reason.starts_with("JobHeld") || reason == "job requeued in held state";
}

}  // namespace

void check_availability()
{
    for (const char* program : {"sbatch", "squeue", "scontrol", "srun"})
        if (!is_installed(program))
            throw Error("", "",
                        fmt::format("--slurm: '{}' is not installed here; run this where you submit jobs, or print the "
                                    "scripts with --dry-run",
                                    program));
    run_command({"scontrol", "ping"});
}

std::uint64_t max_task_number()
{
    std::istringstream lines(run_command({"scontrol", "show", "config"}));
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("MaxArraySize")) continue;
        const std::uint64_t size = std::strtoull(line.substr(line.find('=') + 1).c_str(), nullptr, 10);
        if (size > 0) return size - 1;
    }
    return 1000;  // Slurm's default
}

std::optional<std::vector<std::string>> paths_missing_on_nodes(const std::vector<std::string>& paths,
                                                               const std::vector<std::string>& scheduler_options)
{
    std::vector<std::string> words = {"srun",       "--quiet",   "--immediate=5",         "--nodes=1",
                                      "--ntasks=1", "--chdir=/", "--job-name=fathom-look"};
    // Only options that choose nodes: srun does not know all options of sbatch.
    for (const std::string& word : scheduler_options)
        for (const char* which :
             {"--partition=", "--account=", "--qos=", "--constraint=", "--reservation=", "--nodelist="})
            if (word.starts_with(which)) words.push_back(word);
    words.insert(words.end(),
                 {"/bin/sh", "-c", "for p do test -r \"$p\" || printf '%s\\n' \"$p\"; done; echo .", "sh"});
    words.insert(words.end(), paths.begin(), paths.end());
    const ProcessResult result = run_process(words);
    std::vector<std::string> lines = split(result.out, '\n');
    if (lines.size() < 2 || lines[lines.size() - 2] != ".") return {};
    lines.resize(lines.size() - 2);
    return lines;
}

std::string submit(const std::string& script, const std::string& folder)
{
    std::string job = run_command({"sbatch", "--parsable", "--chdir=" + folder}, script);
    job.resize(job.find_first_of(";\n") == std::string::npos ? job.size() : job.find_first_of(";\n"));
    if (job.empty() || job.find_first_not_of("0123456789") != std::string::npos)
        throw Error("", "", fmt::format("sbatch: expected a job number, found '{}'", job));
    return job;
}

std::optional<Queue> queue_of(const JobPlan& plan)
{
    // Jobs are listed by name: a list of numbers fails if Slurm has forgotten one of them.
    const ProcessResult result = run_process(
        {"squeue", "--noheader", "--array", "--name=" + job_name(plan), "--states=all", "--format=%F|%K|%T|%N|%r"});
    if (result.exit_code != 0) return {};
    Queue queue;
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);) {
        const std::vector<std::string> words = split(line, '|');
        if (words.size() < 5) continue;
        const std::string& state = words[2];
        const bool is_running = state == "RUNNING" || state == "COMPLETING";
        const bool waits = state == "PENDING" || state == "REQUEUED" || state == "REQUEUE_HOLD" ||
                           state == "SUSPENDED" || state == "CONFIGURING" || state == "REQUEUE_FED";
        if (!is_running && !waits) continue;
        Task task{is_running, words[0], state, words[4].starts_with("launch failed"), is_held(state, words[4]),
                  words[3]};
        for (const Submission& s : plan.submissions) {
            if (words[0] == s.merge) queue.merge = task;
            if (words[0] != s.array) continue;
            task.id += "_" + words[1];
            queue.parts[std::strtoull(words[1].c_str(), nullptr, 10)] = task;
        }
    }
    return queue;
}

void cancel(const std::string& job)
{
    run_process({"scancel", job});  // fails for a job that has ended, which does no harm
}

}  // namespace fathom::cli::slurm
