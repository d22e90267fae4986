// SPDX-License-Identifier: Apache-2.0
#include "commands/commands.h"
#include "process/interrupt.h"
#include "process/streams.h"

int main(int argc, char** argv)
{
    fathom::cli::seconds_since_start();
    fathom::cli::reserve_standard_streams();
    fathom::cli::ignore_write_signals();
    return fathom::cli::run_program(argc, argv);
}
