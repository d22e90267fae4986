#pragma once
#include <atomic>

namespace fathom::cli {

/// From here on Ctrl-C (SIGTERM, SIGHUP) prints `line` and ends the program at once: there is nothing to be kept yet.
/// SIGUSR1 only makes picture_is_wanted() tell so.
void end_on_interrupt(const char* line);
/// From here on the first of them sets interrupted() and prints `line`; the second ends the program, but for a
/// SIGTERM within two seconds, which is taken for the first one's echo.
void finish_on_interrupt(const char* line);
const std::atomic<bool>& interrupted();
/// As if a signal had come, without a word.
void interrupt_now();
/// Whether a picture of the state was asked for since the last call.
bool picture_is_wanted();

/// A file-size limit or a closed pipe becomes an error of writing, not the program's end.
void ignore_write_signals();

}  // namespace fathom::cli
