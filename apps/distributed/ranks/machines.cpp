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

/// "0-3,8"
std::set<int> numbers_of(const std::string& ranges)
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

RankPlace place_here()
{
    char host[256] = "";
    if (gethostname(host, sizeof host - 1) != 0) host[0] = 0;
    return {host[0] ? host : "localhost", cores_of(0), cores_of(getppid()), available_threads()};
}

std::vector<int> shared_threads(const std::vector<RankPlace>& places)
{
    // On each machine, how many ranks may run on a core, and how many there are.
    std::map<std::string, std::map<int, int>> users;
    std::map<std::string, int> ranks;
    for (const RankPlace& place : places) {
        ++ranks[place.host];
        for (const int core : numbers_of(place.cores)) ++users[place.host][core];
    }
    // Whole threads of what is no whole number for each: what one rank leaves the next one gets.
    std::map<std::string, double> left;
    std::vector<int> threads;
    for (const RankPlace& place : places) {
        const std::set<int> cores = numbers_of(place.cores);
        double share = 0;
        for (const int core : cores) share += 1.0 / users[place.host][core];
        // A container's limit on time holds for all ranks in it.
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

int machines_of(const std::vector<RankPlace>& places)
{
    std::set<std::string> hosts;
    for (const RankPlace& place : places) hosts.insert(place.host);
    return int(hosts.size());
}

IdleCores idle_cores(const std::vector<RankPlace>& places)
{
    std::map<std::string, std::set<int>> used, all;
    for (const RankPlace& place : places) {
        used[place.host].merge(numbers_of(place.cores));
        all[place.host].merge(numbers_of(place.launcher_cores));
    }
    IdleCores cores;
    for (const auto& [host, numbers] : all) {
        cores.all += int(numbers.size());
        for (const int n : numbers) cores.idle += !used[host].contains(n);
    }
    return cores;
}

}  // namespace fathom::cli
