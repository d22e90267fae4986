#pragma once
#include <cstdint>
#include <filesystem>

/// What the machine and the process's control groups (Linux, versions 1 and 2) leave to this process. `root` stands for
/// the root of the file system: tests put another there.
namespace fathom {

std::uint64_t memory_left(const std::filesystem::path& root);
/// What this process has of the machine's memory now; 0 if that can't be known.
std::uint64_t resident_memory(const std::filesystem::path& root);

/// Cores that the process may run on, no more than the time that its groups may use of them; 1 at least.
int usable_cores(const std::filesystem::path& root);

/// How many threads can be there at once beside those that are, at most `wanted`; this one counts. Libraries end the
/// program, or fail for good, when one of theirs can't be started: they must not try.
int startable_threads(int wanted);

}  // namespace fathom
