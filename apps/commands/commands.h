#pragma once
#include <chrono>
#include <functional>
#include <stdexcept>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fathom::cli {

/// What the program returns, as --help says.
enum ExitCode { exit_ok = 0, exit_error = 1, exit_usage = 2, exit_interrupted = 130 };

/// An option that is not as it must be; the program returns exit_usage.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Set by the command that the command line chose; returns the exit code.
using Run = std::function<int()>;

void add_render(CLI::App& app, Run& run);
void add_merge(CLI::App& app, Run& run);
void add_submit(CLI::App& app, Run& run);
void add_status(CLI::App& app, Run& run);
void add_info(CLI::App& app, Run& run);
void add_convert(CLI::App& app, Run& run);
void add_view(CLI::App& app, Run& run);
void add_version(CLI::App& app, Run& run);

/// Reads the command line, does what it says, prints what went wrong; returns the exit code.
int run_program(int argc, char** argv);

/// Seconds since the program began.
double seconds_since_start();

}  // namespace fathom::cli
