#include "interrupt.h"

#include <unistd.h>
#include <csignal>
#include <cstring>

#include "commands.h"

namespace fathom::cli {

namespace {

std::atomic<bool> interrupt_flag = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");
const char* interrupt_line = "";

void print(const char* text)
{
    // Nothing can be done if the terminal is gone.
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
}

void on_signal(int)
{
    if (interrupt_flag.exchange(true)) _exit(exit_interrupted);
    print(interrupt_line);
}

}  // namespace

void finish_on_interrupt(const char* line)
{
    interrupt_line = line;
    struct sigaction action{};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    // The terminal was closed; under nohup that is to mean nothing.
    struct sigaction before{};
    if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

const std::atomic<bool>& interrupted()
{
    return interrupt_flag;
}

void ignore_write_signals()
{
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace fathom::cli
