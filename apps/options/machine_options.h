// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "options/command.h"

namespace fathom::cli {

/// Adds --memory and --nice. Both take effect for the whole process as soon as they are parsed.
void add_machine_options(Command& command);

}  // namespace fathom::cli
