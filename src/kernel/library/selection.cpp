// SPDX-License-Identifier: Apache-2.0
#include "kernel/library/selection.h"

#include <fmt/format.h>

#include "fathom/error.h"

namespace fathom {

namespace {

constexpr std::size_t avx2_level = 1;

std::size_t requested_level(std::size_t supported, const std::string& requested)
{
    for (std::size_t level = 0; level < kernel_levels.size(); ++level) {
        if (requested != kernel_levels[level].name) continue;
        if (level > supported)
            throw Error("", "",
                        fmt::format("FATHOM_KERNEL={}: this machine does not support {}", requested,
                                    kernel_levels[level].requirement));
        return level;
    }
    throw Error("", "", fmt::format("FATHOM_KERNEL: expected avx512, avx2 or base, found '{}'", requested));
}

[[noreturn]] void report_missing(std::size_t level, const std::string& folder)
{
    throw Error("", "", fmt::format("the kernel library {} is missing in {}", kernel_levels[level].file, folder));
}

/// Why the best installed kernel is not the best supported one; empty if it is.
std::string fallback_reason(std::size_t level, std::size_t supported, const std::string& folder)
{
    if (level == supported) return "";
    return fmt::format("{} is missing in {}", kernel_levels[supported].file, folder);
}

}  // namespace

std::size_t supported_kernel_level()
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("x86-64-v4")) return 2;
    if (__builtin_cpu_supports("x86-64-v3")) return 1;
#endif
    return 0;
}

KernelChoice select_kernel(std::size_t supported, const std::string& requested,
                           const std::array<bool, kernel_levels.size()>& installed, const std::string& folder)
{
    if (!requested.empty()) {
        const std::size_t level = requested_level(supported, requested);
        if (!installed[level]) report_missing(level, folder);
        return {kernel_levels[level].name, "FATHOM_KERNEL requests it", ""};
    }
    std::size_t level = supported;
    while (level > 0 && !installed[level]) --level;
    if (!installed[level]) report_missing(supported, folder);
    const std::string name = kernel_levels[level].name;
    if (supported < avx2_level)
        return {name, "this machine supports neither AVX2 nor AVX-512",
                "this machine supports neither AVX2 nor AVX-512: the kernel is one lane wide, and slow"};
    const std::string fallback = fallback_reason(level, supported, folder);
    if (level < avx2_level) return {name, fallback, fallback + ": the kernel is one lane wide, and slow"};
    return {name, fallback.empty() ? "the best that this machine supports" : fallback, ""};
}

}  // namespace fathom
