// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>

namespace fathom::cli {

/// From here on, SIGINT, SIGTERM and SIGHUP print `line` and end the program at once: there is nothing to save yet.
/// SIGUSR1 makes image_is_requested() true.
void end_on_interrupt(const char* line);
/// From here on, the first of these signals sets interrupted() and prints `line`; the second ends the program. A
/// SIGTERM within two seconds of the first is ignored: schedulers send it to the job and to its script, which passes it
/// on.
void finish_on_interrupt(const char* line);
const std::atomic<bool>& interrupted();
/// Sets interrupted() without printing anything.
void interrupt_now();
/// Whether SIGUSR1 has asked for the image so far since the last call.
bool image_is_requested();

/// Makes a file-size limit and a closed pipe errors of write(), instead of ends of the program.
void ignore_write_signals();

}  // namespace fathom::cli
