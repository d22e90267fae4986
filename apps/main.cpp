#include "commands.h"
#include "interrupt.h"

int main(int argc, char** argv)
{
    fathom::cli::seconds_since_start();
    fathom::cli::ignore_write_signals();
    return fathom::cli::run_program(argc, argv);
}
