// SPDX-License-Identifier: Apache-2.0
#include "distributed/slurm/job_status.h"

#include <algorithm>
#include <cmath>

#include "fathom/error.h"
#include "fathom/film_file.h"

namespace fathom::cli {

namespace {

PartStatus read_part_status(const JobPlan& plan, std::uint64_t number, const std::optional<slurm::Queue>& queue)
{
    PartStatus part;
    const SampleRange range = plan.samples_of(number);
    part.number = number;
    part.wanted = range.second - range.first;
    part.film = read_part(plan, number);
    if (queue)
        if (const auto task = queue->parts.find(number); task != queue->parts.end()) part.task = task->second;
    if (part.film.samples >= part.wanted)
        part.state = PartState::done;
    else if (!part.task.state.empty() && !part.task.is_stuck)
        part.state = part.task.is_running ? PartState::running : PartState::waiting;
    else if (!part.film.error.empty())
        part.state = PartState::damaged;
    return part;
}

/// Noise of the mean of all parts, weighted by their samples: the variances of independent images add.
double combined_noise(const std::vector<PartStatus>& parts, std::uint64_t samples)
{
    double variance = 0;
    for (const PartStatus& part : parts) {
        if (part.film.samples > 0 && part.film.noise == 0) return 0;
        const double share = samples > 0 ? double(part.film.samples) / double(samples) : 0;
        variance += share * share * part.film.noise * part.film.noise;
    }
    return std::sqrt(variance);
}

/// Time until all running and waiting parts are done, if as many run at once as do now.
std::optional<double> estimate_time_left(const std::vector<PartStatus>& parts)
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

}  // namespace

const char* name_of(PartState state)
{
    constexpr const char* names[] = {"done", "running", "waiting", "missing", "damaged"};
    return names[int(state)];
}

JobStatus read_job_status(const JobPlan& plan)
{
    JobStatus status;
    std::optional<slurm::Queue> queue;
    try {
        queue = slurm::queue_of(plan);
    } catch (const Error&) {
        // Without Slurm, the films in the folder still tell the progress.
    }
    status.scheduler_answers = queue.has_value();
    status.merge_waits = queue && queue->merge && !queue->merge->is_stuck;
    if (status.merge_waits) status.merge = *queue->merge;
    for (std::uint64_t number = 1; number <= plan.parts; ++number) {
        status.parts.push_back(read_part_status(plan, number, queue));
        status.samples += std::min(status.parts.back().film.samples, status.parts.back().wanted);
    }
    status.noise = combined_noise(status.parts, status.samples);
    status.left_s = estimate_time_left(status.parts);
    try {
        status.merged = FilmFile(plan.outputs.front()).samples();
    } catch (const Error&) {
        // The image does not exist yet, or is no EXR.
    }
    return status;
}

std::vector<std::uint64_t> parts_in_state(const JobStatus& status, std::initializer_list<PartState> states)
{
    std::vector<std::uint64_t> numbers;
    for (const PartStatus& part : status.parts)
        if (std::find(states.begin(), states.end(), part.state) != states.end()) numbers.push_back(part.number);
    return numbers;
}

}  // namespace fathom::cli
