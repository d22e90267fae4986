// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>

namespace fathom {

/// The result of work in a child process.
struct SubprocessResult {
    std::string bytes;    ///< return value of the work
    std::string failure;  ///< the reason if there is no result: the process crashed, exceeded a limit or could not be
                          ///< started
};

/// Runs `work` in a sandboxed child process (see enter_sandbox), so that crashes and damage stay there.
///
/// The child may use `seconds` of CPU time, slightly more than three times that of wall time, and `memory_bytes` beyond
/// the memory of the parent. It is killed when the parent exits, and its output is discarded.
SubprocessResult run_in_subprocess(const std::function<std::string()>& work, unsigned seconds,
                                   std::size_t memory_bytes);

}  // namespace fathom
