// SPDX-License-Identifier: Apache-2.0
#include "distributed/ranks/environment.h"

#include <fmt/format.h>
#include <sched.h>

#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

namespace fathom::cli {

namespace {

/// The number in an environment variable; -1 if it is absent or invalid.
int number_of(const char* variable)
{
    const char* const text = std::getenv(variable);
    if (!text) return -1;
    int number = -1;
    const char* const end = text + std::strlen(text);
    const auto [stop, error] = std::from_chars(text, end, number);
    return error == std::errc() && stop == end ? number : -1;
}

}  // namespace

RankEnvironment rank_environment()
{
    constexpr struct {
        const char *count, *rank;
    } launchers[] = {{"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"},
                     {"PMI_SIZE", "PMI_RANK"},
                     // PMIx sets only the rank; srun without it starts independent programs.
                     {"SLURM_STEP_NUM_TASKS", "PMIX_RANK"}};
    for (const auto& launcher : launchers) {
        const int count = number_of(launcher.count), rank = number_of(launcher.rank);
        if (count > 1 && rank >= 0 && rank < count) return {rank, count, launcher.count};
    }
    return {};
}

void let_rank0_report_first()
{
    // Open MPI needs about a second to end the remaining processes.
    std::this_thread::sleep_for(std::chrono::seconds(3));
}

std::string cores_of(int process)
{
    // The set is larger than cpu_set_t, because the kernel fails if it is too small for the machine.
    constexpr std::size_t max_cores = 1 << 16, word_bits = 8 * sizeof(unsigned long);
    std::vector<unsigned long> words(max_cores / word_bits);
    const std::size_t bytes = words.size() * sizeof(unsigned long);
    auto* const set = reinterpret_cast<cpu_set_t*>(words.data());
    if (sched_getaffinity(process, bytes, set) != 0) return "";
    std::string text;
    for (std::size_t core = 0; core < max_cores; ++core) {
        if (!CPU_ISSET_S(core, bytes, set)) continue;
        const std::size_t first = core;
        while (core + 1 < max_cores && CPU_ISSET_S(core + 1, bytes, set)) ++core;
        text += fmt::format("{}{}", text.empty() ? "" : ",", first);
        if (core > first) text += fmt::format("-{}", core);
    }
    return text;
}

}  // namespace fathom::cli
