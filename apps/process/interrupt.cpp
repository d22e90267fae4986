// SPDX-License-Identifier: Apache-2.0
#include "process/interrupt.h"

#include <unistd.h>
#include <csignal>
#include <cstring>
#include <ctime>

#include "commands/commands.h"

namespace fathom::cli {

namespace {

std::atomic<bool> interrupt_flag = false, image_flag = false, has_samples_to_save = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets them");
std::atomic<const char*> interrupt_line = "";
std::atomic<long long> interrupt_ms = 0;

void print_in_handler(const char* text)
{
    // A failure can't be reported anywhere.
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
}

long long now_ms()
{
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1000LL + now.tv_nsec / 1'000'000;
}

/// Whether a signal repeats the one before, because a scheduler signals both a job and its script.
bool is_echo(int signal)
{
    constexpr long long max_echo_ms = 2000;
    return signal == SIGTERM && now_ms() - interrupt_ms < max_echo_ms;
}

void on_signal(int signal)
{
    if (interrupt_flag.exchange(true)) {
        if (is_echo(signal)) return;
        _exit(exit_interrupted);
    }
    interrupt_ms = now_ms();
    print_in_handler(interrupt_line);
    if (!has_samples_to_save) _exit(exit_interrupted);
}

void on_image_signal(int)
{
    image_flag = true;
}

void set_handler(int signal, void (*handler)(int))
{
    struct sigaction action{};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigaction(signal, &action, nullptr);
}

void install_handlers()
{
    set_handler(SIGINT, on_signal);
    set_handler(SIGTERM, on_signal);
    // SIGHUP means that the terminal was closed; nohup ignores it, and so does Fathom then.
    struct sigaction before{};
    if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) set_handler(SIGHUP, on_signal);
    set_handler(SIGUSR1, on_image_signal);
}

}  // namespace

void end_on_interrupt(const char* line)
{
    interrupt_line = line;
    has_samples_to_save = false;
    install_handlers();
}

void finish_on_interrupt(const char* line)
{
    interrupt_line = line;
    has_samples_to_save = true;
    install_handlers();
}

bool image_is_requested()
{
    return image_flag.exchange(false);
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
