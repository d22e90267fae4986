#pragma once
#include <functional>
#include <string>

namespace fathom {

/// What came of work in a process of its own.
struct SubprocessResult {
    std::string bytes;    ///< what the work returned
    std::string failure;  ///< why there is none: the process crashed, took too long, or could not be started
};

/// Does the work in a child process, so that whatever happens to it happens there. The child has `seconds` of processor
/// time, somewhat more than three times that to end, and `memory_bytes` beyond what the program holds already; it may
/// read files, and change nothing (enter_sandbox); it ends with the program. What it prints is not seen.
SubprocessResult run_in_subprocess(const std::function<std::string()>& work, unsigned seconds,
                                   std::size_t memory_bytes);

}  // namespace fathom
