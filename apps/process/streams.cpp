// SPDX-License-Identifier: Apache-2.0
#include "process/streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <system_error>

#include "fathom/error.h"

namespace fathom::cli {

namespace {

std::atomic<bool> has_failed = false;

/// Returns 0, or the errno of a failed write.
int write_all(int descriptor, const std::string& text)
{
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t n = write(descriptor, text.data() + done, text.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return errno;
        done += std::size_t(n);
    }
    return 0;
}

}  // namespace

void reserve_standard_streams()
{
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(descriptor, F_GETFD) < 0) {
            // open() takes the lowest free number, which is `descriptor`. Writing to it fails.
            [[maybe_unused]] const int opened = open("/dev/null", O_RDONLY);
        }
}

void write_stderr(const std::string& text)
{
    if (write_all(STDERR_FILENO, text) != 0) has_failed = true;
}

bool stderr_failed()
{
    return has_failed;
}

void write_stdout(const std::string& text)
{
    if (const int code = write_all(STDOUT_FILENO, text))
        throw Error("standard output", "", "can't write: " + std::generic_category().message(code));
}

}  // namespace fathom::cli
