#include "import/assimp/apart.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

namespace fathom {

namespace {

[[maybe_unused]] std::size_t memory_in_use()
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
#ifndef __SANITIZE_ADDRESS__  // whose shadow is larger than any limit
    const rlimit memory{memory_in_use() + memory_bytes, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &memory);
#endif
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

[[noreturn]] void run_child(const std::function<std::string()>& work, int out, unsigned seconds,
                            std::size_t memory_bytes)
{
    // Handlers of the program, as for Ctrl-C, must not run twice.
    for (int signal : {SIGINT, SIGTERM, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGXCPU})
        std::signal(signal, SIG_DFL);
    if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
        dup2(nowhere, STDOUT_FILENO);
        dup2(nowhere, STDERR_FILENO);
    }
    limit(seconds, memory_bytes);
    try {
        write_all(out, work());
    } catch (...) {
        _exit(2);
    }
    // No destructors, no exit handlers: they belong to the parent.
    _exit(0);
}

std::string reason(int status)
{
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
        return "it took too long or too much memory";
    if (WIFSIGNALED(status)) return "it crashed";
    return WEXITSTATUS(status) == 2 ? "it ran out of memory" : "it failed";
}

}  // namespace

ApartResult run_apart(const std::function<std::string()>& work, unsigned seconds, std::size_t memory_bytes)
{
    ApartResult result;
    int ends[2];
    if (pipe(ends) != 0) {
        result.failure = std::strerror(errno);
        return result;
    }
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        run_child(work, ends[1], seconds, memory_bytes);
    }
    const int error = errno;
    close(ends[1]);
    if (child < 0) {
        close(ends[0]);
        result.failure = std::strerror(error);
        return result;
    }
    std::size_t size = 0;
    result.bytes.resize(1 << 16);
    for (;;) {
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
