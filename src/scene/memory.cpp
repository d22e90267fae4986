#include "fathom/memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace fathom {

#ifdef __linux__
namespace {

constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max();

/// The number after `key` in a file of lines `key number ...`; with an empty key, the number that begins the file.
std::uint64_t number_in(const char* file, const std::string& key)
{
    std::ifstream in(file);
    std::string line;
    while (std::getline(in, line)) {
        if (line.compare(0, key.size(), key) != 0) continue;
        const std::size_t digits = line.find_first_of("0123456789", key.size());
        return digits == std::string::npos ? unknown : std::stoull(line.substr(digits, 18));
    }
    return unknown;
}

std::uint64_t difference(std::uint64_t limit, std::uint64_t used)
{
    if (limit == unknown || used == unknown) return unknown;
    return limit > used ? limit - used : 0;
}

}  // namespace

std::uint64_t available_memory_bytes()
{
    std::uint64_t available = unknown;
    const std::uint64_t machine = number_in("/proc/meminfo", "MemAvailable:");
    if (machine != unknown) available = machine * 1024;
    // Inside a container the machine's figure is not what it may use.
    available = std::min(available, difference(number_in("/sys/fs/cgroup/memory.max", ""),
                                               number_in("/sys/fs/cgroup/memory.current", "")));
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        available = std::min(available, difference(limit.rlim_cur, number_in("/proc/self/status", "VmSize:") * 1024));
    return available;
}
#else
std::uint64_t available_memory_bytes()
{
    return std::numeric_limits<std::uint64_t>::max();
}
#endif

}  // namespace fathom
