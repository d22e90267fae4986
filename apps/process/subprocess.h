#pragma once
#include <string>
#include <vector>

namespace fathom::cli {

struct ProcessResult {
    int exit_code = 0;  ///< 128 + the signal's number where one ended it
    std::string out, err;
};

/// Whether a program of this name is to be found.
bool is_installed(const std::string& program);

/// Runs a program, found by PATH, to its end; no shell looks at the words. Throws Error if it can't be started.
///
/// input  what it reads
ProcessResult run_process(const std::vector<std::string>& words, const std::string& input = "");

}  // namespace fathom::cli
