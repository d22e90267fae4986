// SPDX-License-Identifier: Apache-2.0
#include "formats/io/input_file.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <utility>

#include "fathom/error.h"
#include "formats/io/text_encoding.h"

namespace fathom {

namespace {

[[noreturn]] void fail(const std::string& file, int error)
{
    const char* why = std::strerror(error);
    if (error == ENOENT) why = "no such file";
    if (error == EISDIR) why = "is a directory, not a file";
    throw Error(file, "", why);
}

/// Whether the file has a known size, unlike a pipe. Throws Error if it is not a file.
bool is_regular(const std::string& name, int descriptor, const struct stat& status)
{
    if (S_ISDIR(status.st_mode)) fail(name, EISDIR);
    // Reading a device such as /dev/zero might never end.
    if (S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)) throw Error(name, "", "is a device, not a file");
    if (S_ISSOCK(status.st_mode)) throw Error(name, "", "is a socket, not a file");
    if (S_ISFIFO(status.st_mode)) {
        // An anonymous pipe as standard input is accepted: it ends when its writer does. A named pipe might never get a
        // writer.
        struct statfs system{};
        if (fstatfs(descriptor, &system) != 0 || system.f_type != PIPEFS_MAGIC)
            throw Error(name, "", "is a named pipe, not a file");
        fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
    }
    return S_ISREG(status.st_mode);
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& file) : name_(file.string())
{
    // Without O_NONBLOCK, opening a named pipe without a writer would block forever.
    descriptor_ = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0) fail(name_, errno);
    try {
        struct stat status;
        if (fstat(descriptor_, &status) != 0) fail(name_, errno);
        if (!is_regular(name_, descriptor_, status)) {
            read_to_the_end(false);
        } else {
            size_ = std::uint64_t(status.st_size);
            start_.resize(std::size_t(std::min<std::uint64_t>(size_ + 1, 4096)));
            start_.resize(read_some(start_.data(), start_.size()));
            // Files in /proc claim a size of 0.
            if (start_.size() > size_) read_to_the_end(true);
        }
    } catch (...) {
        close(descriptor_);
        throw;
    }
}

InputFile::InputFile(std::string name, std::string bytes)
    : name_(std::move(name)), size_(bytes.size()), start_(std::move(bytes))
{
}

InputFile::InputFile(InputFile&& other) noexcept
    : name_(std::move(other.name_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_),
      start_(std::move(other.start_)),
      at_(other.at_),
      mark_(other.mark_)
{
}

InputFile::~InputFile()
{
    if (descriptor_ >= 0) close(descriptor_);
}

std::size_t InputFile::read_some(char* to, std::size_t size)
{
    std::size_t sum = 0;
    while (sum < size) {
        const ssize_t got = ::read(descriptor_, to + sum, size - sum);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail(name_, errno);
        if (got == 0) break;
        sum += std::size_t(got);
    }
    return sum;
}

void InputFile::read_to_the_end(bool has_size)
{
    try {
        std::size_t size = start_.size();
        // One byte more than the size, because the file may have grown.
        start_.resize(std::max<std::size_t>(has_size ? std::size_t(size_) + 1 : 1 << 16, size + 4096));
        for (;;) {
            const std::size_t got = read_some(start_.data() + size, start_.size() - size);
            size += got;
            if (size < start_.size()) break;
            // Input from a pipe might never end, so its size is limited.
            if (size > (std::size_t(1) << 32) && !has_size)
                throw Error(name_, "", "provides more than 4 GB and is not a regular file");
            start_.resize(2 * size);
        }
        start_.resize(size);
    } catch (const std::bad_alloc&) {
        throw Error(name_, "", "does not fit into memory");
    } catch (const std::length_error&) {
        throw Error(name_, "", "does not fit into memory");
    }
    size_ = start_.size();
    close(std::exchange(descriptor_, -1));
}

void InputFile::skip_byte_order_mark()
{
    const std::size_t before = start_.size();
    start_.erase(0, before - utf8_text(name_, start_).size());
    mark_ += before - start_.size();
    size_ -= before - start_.size();
}

const std::string& InputFile::bytes()
{
    if (descriptor_ >= 0) {
        // Pieces read earlier were not kept, so reading restarts behind the head.
        if (at_ > start_.size() && lseek(descriptor_, off_t(mark_ + start_.size()), SEEK_SET) < 0) fail(name_, errno);
        read_to_the_end(true);
    }
    return start_;
}

std::string InputFile::take() &&
{
    bytes();
    return std::move(start_);
}

std::size_t InputFile::read(char* to, std::size_t size)
{
    std::size_t got = 0;
    if (at_ < start_.size()) {
        got = std::min(size, start_.size() - std::size_t(at_));
        std::memcpy(to, start_.data() + at_, got);
    }
    if (got < size && descriptor_ >= 0) got += read_some(to + got, size - got);
    at_ += got;
    return got;
}

}  // namespace fathom
