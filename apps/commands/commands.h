// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <stdexcept>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fathom::cli {

/// Exit codes of the program, as --help lists them.
enum ExitCode {
    exit_ok = 0,
    exit_error = 1,
    exit_usage = 2,
    exit_not_reached = 3,
    exit_not_reference = 4,
    exit_interrupted = 130
};
/// Exit codes of `fathom diff`, which are those of cmp and diff.
enum DiffExitCode { exit_same = 0, exit_different = 1, exit_trouble = 2 };

/// An invalid or contradictory option; the program returns exit_usage.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The action of the command that the command line names; returns the exit code.
using Run = std::function<int()>;

void add_render(CLI::App& program, Run& run);
void add_merge(CLI::App& program, Run& run);
void add_submit(CLI::App& program, Run& run);
void add_status(CLI::App& program, Run& run);
void add_info(CLI::App& program, Run& run);
void add_convert(CLI::App& program, Run& run);
void add_diff(CLI::App& program, Run& run);
void add_view(CLI::App& program, Run& run);
void add_why(CLI::App& program, Run& run);
void add_version(CLI::App& program, Run& run);
void add_completion(CLI::App& program, Run& run);
void add_man(CLI::App& program, Run& run);

/// Adds all commands and the program's own help.
void add_commands(CLI::App& program, Run& run);

/// Parses the command line, runs its command and prints errors; returns the exit code.
int run_program(int argc, char** argv);

/// Seconds since the program's start.
double seconds_since_start();

}  // namespace fathom::cli
