#pragma once
#include <string>

namespace fathom::cli {

/// Gives standard streams that are closed a descriptor that refuses everything: else the next file that is opened, as
/// the picture, gets their numbers and what is said is written into it.
void hold_standard_streams();

/// Writes to standard error. A reader that is gone is no reason to lose a picture: what can't be written is only
/// remembered.
void say(const std::string& text);
/// Whether something that was to be said could not be.
bool could_not_say();

/// Writes to standard output. Throws Error if that can't be.
void print(const std::string& text);

}  // namespace fathom::cli
