#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fathom/api.h"
#include "fathom/tree_build.h"

namespace fathom {

struct SceneDescription;

/// Bytes that this process can still take without swapping or being killed: what the machine has free, limited by the
/// process's own limits, its container's, and limit_memory. The largest number if that can't be known.
FATHOM_API std::uint64_t available_memory_bytes();
/// The same in words, to end a message with: `1.5 GB are there`, or, where limit_memory leaves less, what it allows.
FATHOM_API std::string available_memory_text();

/// From now on this process takes no more memory than this, what it has taken already counted. What would need more is
/// refused by an Error that names `said_by`; nothing is taken away from libraries that don't ask.
FATHOM_API void limit_memory(std::uint64_t bytes, std::string said_by);

/// Something that is going to take memory.
struct MemoryEstimate {
    std::string what;
    double bytes = 0;
};
/// What compiling a scene takes at its peak and what the scene then is, by a look at the description and at the heads
/// of the picture files. Rather too much than too little; not counted is what displacement adds. The scene must be one
/// that Scene::compile accepts.
FATHOM_API std::vector<MemoryEstimate> estimate_memory(const SceneDescription& scene, TreeBuild build);
/// Throws Error, naming `file` and the largest takers, if there is less memory than all of that needs.
FATHOM_API void check_memory(const std::string& file, std::vector<MemoryEstimate> needs);

/// `1.5 GB`, `512 MB`: powers of 1000, as options and messages have them.
FATHOM_API std::string memory_text(double bytes);

}  // namespace fathom
