#include "options/machine_options.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "fathom/error.h"
#include "fathom/memory.h"

namespace fathom::cli {

namespace {

/// As `nice -n`: added to what the process has.
void be_nice(int more)
{
    errno = 0;
    if (nice(more) == -1 && errno != 0) throw Error("--nice", "", std::generic_category().message(errno));
}

}  // namespace

void add_machine_options(Command& command)
{
    command.add_value("--memory", "SIZE",
                      "take no more memory than 8G, 512M or 1.5GiB: what needs more is refused before it is begun "
                      "(default: what the machine has free, a container's limit counted)",
                      [](const std::string& text) { limit_memory(parse_bytes(text), "--memory"); });
    command.add_value("--nice", "N", "give way to other programs: 0 to 19, as `nice -n N` (default 0)",
                      [](const std::string& text) { be_nice(int(parse_integer(text, 0, 19))); });
}

}  // namespace fathom::cli
