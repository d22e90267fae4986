#include "process/interrupt.h"

#include <unistd.h>
#include <csignal>
#include <cstring>
#include <ctime>

#include "commands/commands.h"

namespace fathom::cli {

namespace {

std::atomic<bool> interrupt_flag = false, picture_flag = false, has_something_to_keep = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");
std::atomic<const char*> interrupt_line = "";
std::atomic<long long> interrupt_ms = 0;

void print(const char* text)
{
    // Nothing can be done if the terminal is gone.
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
}

long long now_ms()
{
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000LL + now.tv_nsec / 1'000'000;
}

/// Whether it is the request that came before, once more: schedulers signal a job, and its script passes that on.
bool is_echo(int signal)
{
    constexpr long long longest_ms = 2000;
    return signal == SIGTERM && now_ms() - interrupt_ms < longest_ms;
}

void on_signal(int signal)
{
    if (interrupt_flag.exchange(true)) {
        if (is_echo(signal)) return;
        _exit(exit_interrupted);
    }
    interrupt_ms = now_ms();
    print(interrupt_line);
    if (!has_something_to_keep) _exit(exit_interrupted);
}

void on_picture_signal(int)
{
    picture_flag = true;
}

void handle(int signal, void (*handler)(int))
{
    struct sigaction action{};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
}

void take_signals()
{
    handle(SIGINT, on_signal);
    handle(SIGTERM, on_signal);
    // The terminal was closed; under nohup that is to mean nothing.
    struct sigaction before{};
    if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) handle(SIGHUP, on_signal);
    handle(SIGUSR1, on_picture_signal);
}

}  // namespace

void end_on_interrupt(const char* line)
{
    interrupt_line = line;
    take_signals();
}

void finish_on_interrupt(const char* line)
{
    interrupt_line = line;
    has_something_to_keep = true;
    take_signals();
}

bool picture_is_wanted()
{
    return picture_flag.exchange(false);
}

const std::atomic<bool>& interrupted()
{
    return interrupt_flag;
}

void interrupt_now()
{
    if (!interrupt_flag.exchange(true)) interrupt_ms = now_ms();
}

void ignore_write_signals()
{
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace fathom::cli
