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

std::atomic<bool> lost = false;

/// 0, or the reason why not all was written.
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

void hold_standard_streams()
{
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(descriptor, F_GETFD) < 0) {
            // The lowest free number is the one that was found free. It may not be written to.
            [[maybe_unused]] const int opened = open("/dev/null", O_RDONLY);
        }
}

void say(const std::string& text)
{
    if (write_all(STDERR_FILENO, text) != 0) lost = true;
}

bool could_not_say()
{
    return lost;
}

void print(const std::string& text)
{
    if (const int reason = write_all(STDOUT_FILENO, text))
        throw Error("standard output", "", "can't write: " + std::generic_category().message(reason));
}

}  // namespace fathom::cli
