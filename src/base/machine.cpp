// SPDX-License-Identifier: Apache-2.0
#include "base/machine.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#ifdef __linux__
#include <sched.h>
#include <sys/resource.h>
#endif

namespace fathom {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max();

/// Returns the number after `key` in a file of lines `key number ...`; with an empty key, the first number of the file.
std::uint64_t number_in(const fs::path& file, const std::string& key)
{
    std::ifstream in(file);
    std::string line;
    while (std::getline(in, line)) {
        if (line.compare(0, key.size(), key) != 0) continue;
        const std::size_t digits = line.find_first_not_of(" \t:", key.size());
        if (digits == std::string::npos || line[digits] < '0' || line[digits] > '9') return unknown;
        return std::stoull(line.substr(digits, 19));
    }
    return unknown;
}

std::uint64_t difference(std::uint64_t limit, std::uint64_t used)
{
    if (limit == unknown || used == unknown) return unknown;
    return limit > used ? limit - used : 0;
}

/// A cgroup hierarchy: its mount point and the group of this process in it.
struct Hierarchy {
    bool is_v2;
    fs::path mount, group;
};

bool contains_word(const std::string& list, const std::string& word)
{
    std::istringstream words(list);
    for (std::string one; std::getline(words, one, ',');)
        if (one == word) return true;
    return false;
}

/// Hierarchies that a controller belongs to, from the lines `number:controllers:path` of /proc/self/cgroup. Lines of
/// version 2 list no controllers.
std::vector<Hierarchy> hierarchies_of(const fs::path& root, const std::string& controller)
{
    const fs::path mounts = root / "sys/fs/cgroup";
    std::error_code error;
    std::vector<Hierarchy> found;
    std::ifstream lines(root / "proc/self/cgroup");
    for (std::string line; std::getline(lines, line);) {
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1);
        const fs::path group = fs::path(line.substr(second + 1)).relative_path();
        if (controllers.empty()) {
            // In a hybrid setup (both versions mounted), version 2 has a folder of its own.
            const bool hybrid = fs::is_directory(mounts / "unified", error);
            found.push_back({true, hybrid ? mounts / "unified" : mounts, group});
        } else if (contains_word(controllers, controller)) {
            const fs::path together = mounts / controllers;
            found.push_back({false, fs::is_directory(together, error) ? together : mounts / controller, group});
        }
    }
    // A container may see its group in /sys although /proc/self/cgroup doesn't list it.
    if (found.empty()) found = {{true, mounts, {}}, {false, mounts / controller, {}}};
    return found;
}

/// Calls use(folder) for the group and its visible ancestors: a limit of any of them applies.
template <class Use>
void for_groups(const Hierarchy& hierarchy, const Use& use)
{
    fs::path group;
    for (const fs::path& part : hierarchy.group.lexically_normal())
        if (part != "..") group /= part;
    for (;; group = group.parent_path()) {
        use(hierarchy.mount / group);
        if (group.empty()) return;
    }
}

/// Bytes that the group's limit leaves. Inactive file cache counts as free: the kernel drops it when memory is needed.
std::uint64_t left_in_group(const fs::path& group, bool is_v2)
{
    const std::uint64_t limit = number_in(group / (is_v2 ? "memory.max" : "memory.limit_in_bytes"), "");
    const std::uint64_t used = number_in(group / (is_v2 ? "memory.current" : "memory.usage_in_bytes"), "");
    const std::uint64_t cache = number_in(group / "memory.stat", is_v2 ? "inactive_file " : "total_inactive_file ");
    return difference(limit, cache == unknown || used == unknown ? used : difference(used, cache));
}

/// The CPU quota of the group in cores; infinite without a limit.
double cores_of_group(const fs::path& group, bool is_v2)
{
    double quota = -1, period = -1;
    if (is_v2) {
        std::ifstream(group / "cpu.max") >> quota >> period;
    } else {
        std::ifstream(group / "cpu.cfs_quota_us") >> quota;
        std::ifstream(group / "cpu.cfs_period_us") >> period;
    }
    return quota > 0 && period > 0 ? quota / period : std::numeric_limits<double>::infinity();
}

int cores_of_process()
{
#ifdef __linux__
    // sched_getaffinity fails on machines with more cores than cpu_set_t holds; all cores are used then.
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(1, CPU_COUNT(&set));
#endif
    return int(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace

std::uint64_t memory_left(const fs::path& root)
{
    std::uint64_t left = unknown;
    const std::uint64_t machine = number_in(root / "proc/meminfo", "MemAvailable:");
    if (machine != unknown) left = machine * 1024;
    for (const Hierarchy& h : hierarchies_of(root, "memory"))
        for_groups(h, [&](const fs::path& group) { left = std::min(left, left_in_group(group, h.is_v2)); });
#ifdef __linux__
    rlimit limit{};
    const std::uint64_t size = number_in(root / "proc/self/status", "VmSize:");
    if (size != unknown && getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        left = std::min(left, difference(limit.rlim_cur, size * 1024));
#endif
    return left;
}

std::uint64_t resident_memory(const fs::path& root)
{
    const std::uint64_t kilobytes = number_in(root / "proc/self/status", "VmRSS:");
    return kilobytes == unknown ? 0 : kilobytes * 1024;
}

int usable_cores(const fs::path& root)
{
    double cores = cores_of_process();
    for (const Hierarchy& h : hierarchies_of(root, "cpu"))
        for_groups(h, [&](const fs::path& group) { cores = std::min(cores, cores_of_group(group, h.is_v2)); });
    return std::max(1, int(std::ceil(cores)));
}

}  // namespace fathom
