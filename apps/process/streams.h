// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace fathom::cli {

/// Opens closed standard streams with a descriptor that refuses writes. Otherwise the next file to be opened, such as
/// the image, would get the number of stderr, and messages would be written into it.
void reserve_standard_streams();

/// Writes to standard error. Does not throw, since a closed pipe must not lose an image; see stderr_failed().
void write_stderr(const std::string& text);
/// Whether a call of write_stderr() failed.
bool stderr_failed();

/// Writes to standard output. Throws Error if that fails.
void write_stdout(const std::string& text);

}  // namespace fathom::cli
