// SPDX-License-Identifier: Apache-2.0
#include "distributed/ranks/machines.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <set>

#include "distributed/ranks/environment.h"
#include "fathom/threads.h"
#include "options/arguments.h"

namespace fathom::cli {

namespace {

/// Numbers in ranges such as "0-3,8".
std::set<int> core_numbers(const std::string& ranges)
{
    std::set<int> numbers;
    if (ranges.empty()) return numbers;
    for (const std::string& range : split(ranges, ',')) {
        const std::vector<std::string> ends = split(range, '-');
        for (int n = std::stoi(ends.front()); n <= std::stoi(ends.back()); ++n) numbers.insert(n);
    }
    return numbers;
}

}  // namespace

std::string RankPlace::text() const
{
    return fmt::format("{}\n{}\n{}\n{}", host, cores, launcher_cores, threads);
}

RankPlace RankPlace::parse(const std::string& text)
{
    const std::vector<std::string> lines = split(text, '\n');
    return {lines.at(0), lines.at(1), lines.at(2), std::stoi(lines.at(3))};
}

RankPlace current_place()
{
    char host[256] = "";
    if (gethostname(host, sizeof host - 1) != 0) host[0] = 0;
    return {host[0] ? host : "localhost", cores_of(0), cores_of(getppid()), available_threads()};
}

std::vector<int> assign_threads(const std::vector<RankPlace>& places)
{
    // By machine: the number of ranks that may use each core, and the number of ranks.
    std::map<std::string, std::map<int, int>> users;
    std::map<std::string, int> ranks;
    for (const RankPlace& place : places) {
        ++ranks[place.host];
        for (const int core : core_numbers(place.cores)) ++users[place.host][core];
    }
    // Shares are fractions, threads are not: the rest of one rank goes to the next with the same cores.
    std::map<std::string, double> left;
    std::vector<int> threads;
    for (const RankPlace& place : places) {
        const std::set<int> cores = core_numbers(place.cores);
        double share = 0;
        for (const int core : cores) share += 1.0 / users[place.host][core];
        // A container's CPU limit covers all ranks in it.
        if (cores.empty() || place.threads < int(cores.size()))
            share = std::min(cores.empty() ? 1e9 : share, double(place.threads) / ranks[place.host]);
        constexpr double rounding = 1e-6;
        double& rest = left[place.host + ' ' + place.cores];
        rest += share;
        const int whole = std::max(1, int(rest + rounding));
        rest = std::max(0.0, rest - whole);
        threads.push_back(whole);
    }
    return threads;
}

int count_machines(const std::vector<RankPlace>& places)
{
    std::set<std::string> hosts;
    for (const RankPlace& place : places) hosts.insert(place.host);
    return int(hosts.size());
}

IdleCores idle_cores(const std::vector<RankPlace>& places)
{
    std::map<std::string, std::set<int>> used, all;
    for (const RankPlace& place : places) {
        used[place.host].merge(core_numbers(place.cores));
        all[place.host].merge(core_numbers(place.launcher_cores));
    }
    IdleCores cores;
    for (const auto& [host, numbers] : all) {
        cores.all += int(numbers.size());
        for (const int n : numbers) cores.idle += !used[host].contains(n);
    }
    return cores;
}

}  // namespace fathom::cli
