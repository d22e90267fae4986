// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>

/// Limits of the machine and of the process's control groups (Linux cgroups, versions 1 and 2).
///
/// `root` is the root of the file system; tests pass a folder with made-up /proc and /sys files.
namespace fathom {

/// Bytes that the process can still allocate: the least of available physical memory, control group limits and the
/// address space limit. The largest integer if nothing is known.
std::uint64_t memory_left(const std::filesystem::path& root);
/// Resident memory of this process in bytes; 0 if it is unknown.
std::uint64_t resident_memory(const std::filesystem::path& root);

/// Number of cores that the process may use: its CPU affinity, capped by the CPU quotas of its control groups; at least
/// 1.
int usable_cores(const std::filesystem::path& root);

/// The number of threads, the calling one included, that can exist at once beside the existing ones; at most `wanted`.
///
/// TBB and OIDN abort the program or fail for good when a thread can't be started, so limits are probed beforehand.
int startable_threads(int wanted);

}  // namespace fathom
