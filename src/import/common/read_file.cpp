#include "import/common/read_file.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

#include "fathom/error.h"

namespace fathom {

namespace {

/// Closes a file descriptor.
struct Descriptor {
    int fd;
    ~Descriptor()
    {
        if (fd >= 0) close(fd);
    }
};

[[noreturn]] void fail(const std::filesystem::path& file, int error)
{
    const char* why = std::strerror(error);
    if (error == ENOENT) why = "no such file";
    if (error == EISDIR) why = "is a directory, not a file";
    throw Error(file.string(), "", why);
}

}  // namespace

std::string read_file(const std::filesystem::path& file)
{
    // A pipe that nobody writes to would not be opened for ever.
    const Descriptor opened{open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    if (opened.fd < 0) fail(file, errno);
    struct stat status;
    if (fstat(opened.fd, &status) != 0) fail(file, errno);
    if (S_ISDIR(status.st_mode)) fail(file, EISDIR);
    // It may never end.
    if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) throw Error(file.string(), "", "is a device, not a file");
    if (S_ISSOCK(status.st_mode)) throw Error(file.string(), "", "is a socket, not a file");
    if (S_ISFIFO(status.st_mode)) {
        // Standard input is a pipe without a name: whoever started the program fills it.
        struct statfs system{};
        if (fstatfs(opened.fd, &system) != 0 || system.f_type != PIPEFS_MAGIC)
            throw Error(file.string(), "", "is a named pipe, not a file");
        fcntl(opened.fd, F_SETFL, fcntl(opened.fd, F_GETFL) & ~O_NONBLOCK);
    }

    std::string bytes;
    try {
        // Pipes have no size: they are read until they end, as is a file that grows meanwhile.
        std::size_t size = 0;
        bytes.resize(S_ISREG(status.st_mode) ? std::size_t(status.st_size) + 1 : 1 << 16);
        for (;;) {
            if (size == bytes.size()) {
                // Nor may what fills a pipe.
                if (size > (std::size_t(1) << 32) && !S_ISREG(status.st_mode))
                    throw Error(file.string(), "", "gives more than 4 GB and is no regular file");
                bytes.resize(2 * size);
            }
            const ssize_t got = read(opened.fd, bytes.data() + size, bytes.size() - size);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) fail(file, errno);
            if (got == 0) break;
            size += std::size_t(got);
        }
        bytes.resize(size);
    } catch (const std::bad_alloc&) {
        throw Error(file.string(), "", "does not fit into memory");
    } catch (const std::length_error&) {
        throw Error(file.string(), "", "does not fit into memory");
    }
    return bytes;
}

std::string printable(std::string_view text)
{
    constexpr std::size_t limit = 80;
    std::string result;
    for (char c : text.substr(0, limit)) result += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    if (text.size() > limit) {
        // Not in the middle of a UTF-8 sequence.
        while (!result.empty() && (static_cast<unsigned char>(result.back()) & 0xc0) == 0x80) result.pop_back();
        if (!result.empty() && static_cast<unsigned char>(result.back()) >= 0xc0) result.pop_back();
        result += "...";
    }
    return result;
}

}  // namespace fathom
