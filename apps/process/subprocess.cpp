// SPDX-License-Identifier: Apache-2.0
#include "process/subprocess.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "fathom/error.h"
#include "options/arguments.h"

extern char** environ;

namespace fathom::cli {

namespace {

[[noreturn]] void fail(const std::string& program, int reason)
{
    throw Error("", "", fmt::format("can't run '{}': {}", program, std::generic_category().message(reason)));
}

/// A pipe that closes its ends.
struct Pipe {
    int end[2] = {-1, -1};

    explicit Pipe(const std::string& program)
    {
        if (pipe2(end, O_CLOEXEC) != 0) fail(program, errno);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
    ~Pipe() { close_end(0), close_end(1); }
    void close_end(int which)
    {
        if (end[which] >= 0) close(end[which]);
        end[which] = -1;
    }
};

/// Reads the available bytes of a pipe; closes it at the end of file.
void read_available(Pipe& from, std::string& to)
{
    std::array<char, 4096> bytes;
    const ssize_t size = read(from.end[0], bytes.data(), bytes.size());
    if (size > 0)
        to.append(bytes.data(), std::size_t(size));
    else if (size == 0 || errno != EINTR)
        from.close_end(0);
}

/// Serves all pipes at once: a program that writes before it has read all its input would otherwise block forever.
void exchange(Pipe& in, const std::string& input, Pipe& out, Pipe& err, ProcessResult& result)
{
    std::size_t written = 0;
    if (input.empty()) in.close_end(1);
    while (in.end[1] >= 0 || out.end[0] >= 0 || err.end[0] >= 0) {
        pollfd ends[] = {{in.end[1], POLLOUT, 0}, {out.end[0], POLLIN, 0}, {err.end[0], POLLIN, 0}};
        if (poll(ends, 3, -1) < 0 && errno != EINTR) return;
        if (ends[0].revents != 0) {
            const ssize_t size = write(in.end[1], input.data() + written, input.size() - written);
            if (size > 0) written += std::size_t(size);
            if (written == input.size() || (size < 0 && errno != EINTR)) in.close_end(1);
        }
        if (ends[1].revents != 0) read_available(out, result.out);
        if (ends[2].revents != 0) read_available(err, result.err);
    }
}

}  // namespace

bool is_installed(const std::string& program)
{
    const char* path = std::getenv("PATH");
    for (const std::string& folder : split(path ? path : "", ':')) {
        const std::filesystem::path file = std::filesystem::path(folder.empty() ? "." : folder) / program;
        std::error_code error;
        if (std::filesystem::is_regular_file(file, error) && access(file.c_str(), X_OK) == 0) return true;
    }
    return false;
}

ProcessResult run_process(const std::vector<std::string>& words, const std::string& input)
{
    const std::string& program = words.front();
    Pipe in(program), out(program), err(program);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in.end[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out.end[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, err.end[1], STDERR_FILENO);
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    pid_t child = 0;
    const int reason = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (reason != 0) fail(program, reason);
    in.close_end(0), out.close_end(1), err.close_end(1);

    ProcessResult result;
    exchange(in, input, out, err, result);
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) fail(program, errno);
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}

}  // namespace fathom::cli
