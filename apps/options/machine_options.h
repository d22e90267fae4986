#pragma once
#include "options/arguments.h"

namespace fathom::cli {

/// What of the machine a command may take: --memory and --nice. They hold from when they are read, for all that the
/// process does.
void add_machine_options(Command& command);

}  // namespace fathom::cli
