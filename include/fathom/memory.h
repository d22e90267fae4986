// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/bvh_quality.h"

namespace fathom {

struct SceneDescription;

/// Returns the bytes that this process can still allocate without swapping or being killed: the free memory of the
/// machine, limited by the process's resource limits, its control groups and limit_memory(). Returns the largest number
/// if it is unknown.
FATHOM_API std::uint64_t available_memory_bytes();
/// Returns available_memory_bytes() as the end of an error message, such as `1.5 GB are there`. If limit_memory() is
/// what limits it, the text names that limit instead.
FATHOM_API std::string available_memory_text();

/// Limits the memory of the process, including what it has allocated already. The library checks the limit before large
/// allocations and throws an Error; it does not control allocations of other libraries.
///
/// bytes    The limit.
/// source  Where the limit comes from, for messages, such as an option; must not be empty.
FATHOM_API void limit_memory(std::uint64_t bytes, std::string source);

/// Memory that one part of a task is expected to take.
struct MemoryEstimate {
    std::string what;  ///< The part, such as "triangles" or "textures".
    double bytes = 0;  ///< Bytes at the peak.
};
/// Estimates the memory that compiling a scene takes at its peak, from the description and the headers of its image
/// files.
///
/// Estimates err on the high side. Displaced geometry is not included, because its size is unknown before compilation.
/// Throws Error for a scene that Scene::compile would not accept.
FATHOM_API std::vector<MemoryEstimate> estimate_memory(const SceneDescription& scene, BvhQuality build);
/// Throws Error if the sum of `needs` exceeds the available memory or the limit. The message begins with `file` and
/// names the largest parts.
FATHOM_API void check_memory(const std::string& file, std::vector<MemoryEstimate> needs);

/// Formats bytes with decimal prefixes, such as `512 MB` or `1.5 GB`.
FATHOM_API std::string memory_text(double bytes);

}  // namespace fathom
