// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "options/command_tables.h"

namespace fathom::cli {

/// Replaces `--config FILE` in a command line by the options of the file, except those that the command line itself
/// has. A line of the file is `name = value`, with the option's long name; `#` begins a comment. Throws UsageError,
/// naming file and line, for a name that is no option of the command, and Error for a file that can't be read.
///
/// words  command line without the program's name
std::vector<std::string> with_config_file(std::vector<std::string> words, const std::vector<CommandTable>& commands);

}  // namespace fathom::cli
