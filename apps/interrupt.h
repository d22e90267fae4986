#pragma once
#include <atomic>

namespace fathom::cli {

/// From here on the first Ctrl-C (SIGTERM, SIGHUP) sets interrupted() and prints `line`; the second ends the program.
void finish_on_interrupt(const char* line);
const std::atomic<bool>& interrupted();

/// A file-size limit or a closed pipe becomes an error of writing, not the program's end.
void ignore_write_signals();

}  // namespace fathom::cli
