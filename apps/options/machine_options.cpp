// SPDX-License-Identifier: Apache-2.0
#include "options/machine_options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "fathom/error.h"
#include "fathom/memory.h"
#include "options/arguments.h"

namespace fathom::cli {

namespace {

/// Adds to the niceness that the process already has, as `nice -n` does.
void raise_niceness(int increment)
{
    errno = 0;
    if (nice(increment) == -1 && errno != 0) throw Error("--nice", "", std::generic_category().message(errno));
}

}  // namespace

void add_machine_options(Command& command)
{
    command.begin_group("Machine");
    command.add_value({"--memory", "SIZE",
                       "memory limit, such as 8G, 512M or 1.5GiB; a render that needs more fails before it starts",
                       "the free memory, within the container's limit"},
                      [](const std::string& text) { limit_memory(parse_bytes(text), "--memory"); });
    command.add_value({"--nice", "N", "lower the priority of the process by 0 to 19, as `nice -n N` does", "0"},
                      [](const std::string& text) { raise_niceness(int(parse_integer(text, 0, 19))); });
}

}  // namespace fathom::cli
