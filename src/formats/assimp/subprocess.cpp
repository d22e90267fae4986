// SPDX-License-Identifier: Apache-2.0
#include "formats/assimp/subprocess.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>

#include "formats/assimp/sandbox.h"

namespace fathom {

namespace {

std::size_t memory_in_use()
{
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * std::size_t(sysconf(_SC_PAGESIZE));
}

void limit(unsigned seconds, std::size_t memory_bytes)
{
    const rlimit no_core{0, 0}, time{seconds, seconds + 1};
    setrlimit(RLIMIT_CORE, &no_core);
    setrlimit(RLIMIT_CPU, &time);
    // The limit is relative to the memory in use: a sanitizer's shadow memory alone exceeds any absolute limit.
    const rlimit memory{memory_in_use() + memory_bytes, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &memory);
}

void write_all(int fd, const std::string& bytes)
{
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t n = write(fd, bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) _exit(1);
        done += std::size_t(n);
    }
}

[[noreturn]] void run_child(const std::function<std::string()>& work, pid_t parent, int out, unsigned seconds,
                            std::size_t memory_bytes)
{
#ifdef PR_SET_PDEATHSIG
    // The child is killed when the parent dies, which may have happened before this call.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
#endif
    // Signal handlers of the parent, such as for Ctrl-C, must not run in the child.
    for (int signal : {SIGINT, SIGTERM, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU})
        std::signal(signal, SIG_DFL);
    if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
        dup2(nowhere, STDOUT_FILENO);
        dup2(nowhere, STDERR_FILENO);
    }
    limit(seconds, memory_bytes);
    enter_sandbox();
    try {
        write_all(out, work());
    } catch (...) {
        _exit(2);
    }
    // Destructors and exit handlers belong to the parent.
    _exit(0);
}

std::string reason(int status)
{
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
        return "it exceeded its time or memory limit";
    if (WIFSIGNALED(status)) return "it crashed";
    return WEXITSTATUS(status) == 2 ? "it ran out of memory" : "it failed";
}

/// Waits for data or the end of the stream; false if the deadline passes first.
bool wait_for_bytes(int fd, std::chrono::steady_clock::time_point deadline)
{
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
        if (left.count() <= 0) return false;
        pollfd waiting{fd, POLLIN, 0};
        const int ready = poll(&waiting, 1, int(std::min<std::int64_t>(left.count(), 1000)));
        if (ready > 0 || (ready < 0 && errno != EINTR)) return true;
    }
}

}  // namespace

SubprocessResult run_in_subprocess(const std::function<std::string()>& work, unsigned seconds, std::size_t memory_bytes)
{
    SubprocessResult result;
    int ends[2];
    if (pipe(ends) != 0) {
        result.failure = std::strerror(errno);
        return result;
    }
    const pid_t parent = getpid(), child = fork();
    if (child == 0) {
        close(ends[0]);
        run_child(work, parent, ends[1], seconds, memory_bytes);
    }
    const int error = errno;
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        result.failure = std::strerror(error);
        return result;
    }
    // RLIMIT_CPU doesn't stop work that blocks.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2 + 3 * std::uint64_t(seconds));
    std::size_t size = 0;
    result.bytes.resize(1 << 16);
    for (;;) {
        if (!wait_for_bytes(ends[0], deadline)) {
            kill(child, SIGKILL);
            break;
        }
        if (size == result.bytes.size()) result.bytes.resize(2 * size);
        const ssize_t n = read(ends[0], result.bytes.data() + size, result.bytes.size() - size);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        size += std::size_t(n);
    }
    result.bytes.resize(size);
    close(ends[0]);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) result.failure = reason(status);
    return result;
}

}  // namespace fathom
