// SPDX-License-Identifier: Apache-2.0
#include "fathom/memory.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <utility>

#include "base/machine.h"
#include "fathom/error.h"

namespace fathom {

namespace {

/// The limit set by limit_memory().
struct Limit {
    std::uint64_t bytes = std::numeric_limits<std::uint64_t>::max();
    std::string source;

    bool is_set() const { return !source.empty(); }
};
std::mutex limit_mutex;
Limit limit_of_process;

Limit limit_now()
{
    const std::lock_guard lock(limit_mutex);
    return limit_of_process;
}

/// Bytes that the limit leaves; resident memory counts against it.
std::uint64_t left_of(const Limit& limit)
{
    if (!limit.is_set()) return limit.bytes;
    const std::uint64_t taken = resident_memory("/");
    return limit.bytes > taken ? limit.bytes - taken : 0;
}

/// Returns freed heap memory to the system: glibc keeps it, and it would count as resident.
void trim_heap()
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

/// The largest estimates in one unit, such as `textures 5.1, triangles 2.9`. Shares below 5 % are left out.
std::string largest_estimates_text(std::vector<MemoryEstimate> needs, double total, double unit)
{
    constexpr std::size_t most = 4;
    constexpr double min_share = 0.05;
    std::sort(needs.begin(), needs.end(),
              [](const auto& a, const auto& b) { return std::pair(-a.bytes, a.what) < std::pair(-b.bytes, b.what); });
    std::string text;
    for (std::size_t i = 0; i < std::min(most, needs.size()); ++i)
        if (i == 0 || needs[i].bytes >= min_share * total)
            text += fmt::format("{}{} {:.{}f}", i > 0 ? ", " : "", needs[i].what, needs[i].bytes / unit,
                                unit < 1e9 ? 0 : 1);
    return text;
}

}  // namespace

std::uint64_t available_memory_bytes()
{
    return std::min(memory_left("/"), left_of(limit_now()));
}

std::string available_memory_text()
{
    const Limit limit = limit_now();
    const std::uint64_t left = left_of(limit), of_machine = memory_left("/");
    if (left < of_machine)
        return fmt::format("{} of the {} allowed by {} are left", memory_text(double(left)),
                           memory_text(double(limit.bytes)), limit.source);
    return memory_text(double(of_machine)) + " are available";
}

void limit_memory(std::uint64_t bytes, std::string source)
{
    const std::lock_guard lock(limit_mutex);
    limit_of_process = {bytes, std::move(source)};
}

void check_memory(const std::string& file, std::vector<MemoryEstimate> needs)
{
    const Limit limit = limit_now();
    double needed = 0;
    for (const MemoryEstimate& need : needs) needed += need.bytes;
    const auto refuse = [&](double total, const std::string& allowed) {
        throw Error(file, "",
                    fmt::format("needs about {} ({}), {}", memory_text(total),
                                largest_estimates_text(std::move(needs), total, total < 1e9 ? 1e6 : 1e9), allowed));
    };
    if (const auto there = double(memory_left("/")); needed > there)
        refuse(needed, memory_text(there) + " are available");
    if (!limit.is_set() || needed <= double(left_of(limit))) return;
    trim_heap();
    const auto taken = double(resident_memory("/"));
    if (needed + taken <= double(limit.bytes)) return;
    needs.push_back({"data read so far", taken});
    refuse(needed + taken, fmt::format("{} allows {}", limit.source, memory_text(double(limit.bytes))));
}

std::string memory_text(double bytes)
{
    constexpr double giga = 1e9, mega = 1e6;
    // Without the margin, 999.6 MB would be printed as 1000 MB.
    if (bytes < 0.9995 * giga) return fmt::format("{:.0f} MB", bytes / mega);
    const std::string number = fmt::format("{:.1f}", bytes / giga);
    return (number.ends_with(".0") ? number.substr(0, number.size() - 2) : number) + " GB";
}

}  // namespace fathom
