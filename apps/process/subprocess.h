// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace fathom::cli {

struct ProcessResult {
    int exit_code = 0;  ///< 128 + the signal number if a signal ended the program
    std::string out, err;
};

/// Whether PATH has a program of this name.
bool is_installed(const std::string& program);

/// Runs a program of PATH to its end, without a shell. Throws Error if it can't be started.
///
/// input  text for its standard input
ProcessResult run_process(const std::vector<std::string>& words, const std::string& input = "");

}  // namespace fathom::cli
