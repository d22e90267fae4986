// SPDX-License-Identifier: Apache-2.0
#include "base/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <climits>
#include <optional>
#include <system_error>
#include <vector>

#include "fathom/error.h"

namespace fathom {

namespace fs = std::filesystem;

namespace {

/// Longest file name in bytes in this folder: 255 in most file systems, fewer in encrypted ones.
std::size_t max_name_length(const fs::path& folder)
{
    const long length = pathconf(folder.c_str(), _PC_NAME_MAX);
    return length > 0 ? std::size_t(length) : NAME_MAX;
}

/// An unpredictable name beside the target: in a folder that others can write to, a link could wait at a known name.
fs::path temporary_name(const fs::path& folder, const fs::path& target)
{
    std::uint64_t number = 0;
    if (getrandom(&number, sizeof number, 0) != ssize_t(sizeof number))
        throw Error(target.string(), "", "can't write: the system provides no random numbers");
    const std::string end = fmt::format(".{:016x}.part", number);
    const std::size_t room = max_name_length(folder);
    return folder / ("." + target.filename().string().substr(0, room > end.size() ? room - end.size() - 1 : 0) + end);
}

/// Throws Error, naming the target, if a name or a whole path is longer than the system allows. The file is first
/// written under the temporary name, whose path may be the longer one.
void check_length(const std::string& target, const fs::path& path, const fs::path& temporary)
{
    const std::size_t name = path.filename().string().size(), max_name = max_name_length(temporary.parent_path());
    if (name > max_name)
        throw Error(target, "",
                    fmt::format("can't write: the name has {} bytes, and this folder allows {}", name, max_name));
    const std::size_t longest = std::max(path.string().size(), temporary.string().size());
    if (longest >= PATH_MAX)
        throw Error(target, "",
                    fmt::format("can't write: the path has {} bytes, and the system allows {}", path.string().size(),
                                PATH_MAX - 1 - (longest - path.string().size())));
}

/// Whether another user may have planted the link to redirect the output: the rule of Linux' protected_symlinks, for
/// all folders that others can write to and not only for sticky ones.
bool is_untrusted_link(const fs::path& link, const fs::path& folder)
{
    struct stat its{}, of_folder{};
    if (lstat(link.c_str(), &its) != 0 || stat(folder.c_str(), &of_folder) != 0) return false;
    const bool others_may_write = of_folder.st_mode & (S_IWGRP | S_IWOTH);
    return others_may_write && its.st_uid != geteuid() && its.st_uid != of_folder.st_uid;
}

/// The path with all symbolic links resolved; nothing if it has none. Throws Error, naming the target, at a link that
/// may be planted.
std::optional<fs::path> followed(const fs::path& target)
{
    constexpr int max_links = 40;  // as in the Linux kernel
    std::error_code error;
    const fs::path whole = fs::absolute(target, error);
    std::vector<fs::path> rest(whole.begin(), whole.end());
    std::reverse(rest.begin(), rest.end());
    fs::path real;
    int links = 0;
    while (!rest.empty()) {
        const fs::path next = rest.back();
        rest.pop_back();
        if (next == ".." || next == "." || next.empty()) {
            if (next == "..") real = real.parent_path();
            continue;
        }
        const fs::path place = real / next;
        if (!fs::is_symlink(place, error)) {
            real = place;
            continue;
        }
        if (is_untrusted_link(place, real))
            throw Error(target.string(), "",
                        fmt::format("can't write: '{}' is a symbolic link of another user in a folder that others can "
                                    "write to; give its target instead",
                                    place.string()));
        const fs::path to = fs::read_symlink(place, error);
        if (error || ++links > max_links) throw Error(target.string(), "", "can't write: too many symbolic links");
        if (to.is_absolute()) real = to.root_path();
        const fs::path relative = to.relative_path();
        const std::vector<fs::path> parts(relative.begin(), relative.end());
        rest.insert(rest.end(), parts.rbegin(), parts.rend());
    }
    if (links == 0) return {};
    return real;
}

}  // namespace

OutputFile::OutputFile(const fs::path& target) : name_(target.string()), target_(target)
{
    if (target == "/dev/stdout") {
        is_stdout_ = nameless_ = true;
        file_ = std::tmpfile();
        if (!file_) fail("can't write: no temporary file", errno);
        return;
    }
    // Renaming over a symbolic link would replace the link, not what it points to.
    if (const auto real = followed(target)) target_ = *real;
    folder_ = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    temporary_ = temporary_name(folder_, target_);
    check_length(name_, target_, temporary_);
    std::error_code error;
    const fs::file_status status = fs::status(target_, error);
    if (fs::is_directory(status)) throw Error(name_, "", "can't write: this is a folder");
    // Devices, pipes and files without write permission must not be replaced.
    if (fs::exists(status) && !fs::is_regular_file(status))
        throw Error(name_, "", "can't write: this is a device or a pipe, not a file");
    if (fs::exists(status) && access(target_.c_str(), W_OK) != 0) fail("can't write", errno);
    if (!fs::exists(folder_, error))
        throw Error(name_, "", fmt::format("can't write: there is no folder '{}'", folder_.string()));
    open_temporary();
    copy_permissions();
}

void OutputFile::open_temporary()
{
    int descriptor = -1;
#ifdef O_TMPFILE
    // linkat() names a nameless file through /proc, which a chroot may lack.
    if (access("/proc/self/fd", F_OK) == 0) descriptor = open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    nameless_ = descriptor >= 0;
#endif
    // Some file systems don't support O_TMPFILE.
    if (descriptor < 0) descriptor = open(temporary_.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_RDWR | O_CLOEXEC, 0666);
    if (descriptor < 0) fail("can't write", errno);
    file_ = fdopen(descriptor, "w+b");
    if (!file_) {
        const int reason = errno;
        close(descriptor);
        if (!nameless_) unlink(temporary_.c_str());
        fail("can't write", reason);
    }
}

/// Copies owner and permissions of the existing file. Only root can keep another owner, so failure of fchown is
/// ignored.
void OutputFile::copy_permissions() const
{
    struct stat before{};
    if (lstat(target_.c_str(), &before) != 0 || !S_ISREG(before.st_mode)) return;
    [[maybe_unused]] const int owned = fchown(fileno(file_), before.st_uid, before.st_gid);
    if (fchmod(fileno(file_), before.st_mode & 0777) != 0) fail("can't write", errno);
}

OutputFile::~OutputFile()
{
    if (!file_) return;
    std::fclose(file_);
    if (!nameless_) unlink(temporary_.c_str());
}

void OutputFile::write(const void* bytes, std::size_t size)
{
    if (std::fwrite(bytes, 1, size, file_) != size) fail("can't write", errno);
}

void OutputFile::write_whole(const void* bytes, std::size_t size)
{
    constexpr std::size_t block = std::size_t(8) << 20, sector = 4096;
    const int descriptor = fileno(file_), flags = fcntl(descriptor, F_GETFL);
    bool direct = false;
#ifdef O_DIRECT
    direct = fcntl(descriptor, F_SETFL, flags | O_DIRECT) == 0;
#endif
    const auto* const begin = static_cast<const unsigned char*>(bytes);
    for (std::size_t done = 0; done < size;) {
        std::size_t length = std::min(block, size - done);
        if (direct && length > sector) length -= length % sector;
        // The last part is no whole sector, and some file systems accept O_DIRECT but reject the writes.
        const auto write_cached = [&] { direct = fcntl(descriptor, F_SETFL, flags) != 0; };
        if (direct && length % sector != 0) write_cached();
        const ssize_t written = ::write(descriptor, begin + done, length);
        if (written > 0) {
            done += std::size_t(written);
            // A nearly full disk may accept part of a block.
            if (direct && done % sector != 0) write_cached();
        } else if (written < 0 && errno == EINVAL && direct) {
            write_cached();
        } else if (written == 0 || errno != EINTR) {
            fail("can't write", written == 0 ? ENOSPC : errno);
        }
    }
}

std::uint64_t OutputFile::report()
{
    const off_t position = ftello(file_);
    if (position < 0) fail("can't write", errno);
    return std::uint64_t(position);
}

void OutputFile::seek(std::uint64_t position)
{
    if (fseeko(file_, off_t(position), SEEK_SET) != 0) fail("can't write", errno);
}

void OutputFile::copy_to_stdout()
{
    if (std::fflush(file_) != 0) fail("can't write", errno);
    std::rewind(file_);
    std::vector<unsigned char> block(std::size_t(1) << 20);
    while (const std::size_t size = std::fread(block.data(), 1, block.size(), file_))
        for (std::size_t done = 0; done < size;) {
            const ssize_t written = ::write(STDOUT_FILENO, block.data() + done, size - done);
            if (written > 0)
                done += std::size_t(written);
            else if (written == 0 || errno != EINTR)
                fail("can't write", written == 0 ? ENOSPC : errno);
        }
}

void OutputFile::commit(const fs::path& previous)
{
    if (is_stdout_) return copy_to_stdout();
    // The data must be on the disk before the name: after a power failure the name then refers to a complete file. Some
    // file systems can't sync, which is no write error.
    if (std::fflush(file_) != 0) fail("can't write", errno);
    if (fsync(fileno(file_)) != 0 && errno != EINVAL && errno != ENOTSUP) fail("can't write", errno);
#ifdef O_TMPFILE
    if (nameless_) {
        const std::string self = fmt::format("/proc/self/fd/{}", fileno(file_));
        if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, temporary_.c_str(), AT_SYMLINK_FOLLOW) != 0)
            fail("can't write", errno);
        nameless_ = false;
    }
#endif
    if (!previous.empty() && fs::exists(target_))
        rename_keeping_earlier(previous);
    else if (std::rename(temporary_.c_str(), target_.c_str()) != 0)
        fail("can't write", errno);
    std::FILE* file = file_;
    file_ = nullptr;
    const int closed = std::fclose(file) == 0 ? 0 : errno;
    sync_folder();
    if (closed != 0) fail("can't write", closed);
}

void OutputFile::rename_keeping_earlier(const fs::path& previous) const
{
    // The new file takes the name of the previous one, so that no third file remains if the program is killed here.
    if (std::rename(temporary_.c_str(), previous.c_str()) != 0) fail("can't write", errno);
#ifdef RENAME_EXCHANGE
    if (renameat2(AT_FDCWD, previous.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0) return;
#endif
    // Some file systems can't exchange two names; the target is missing for a moment then.
    if (std::rename(target_.c_str(), temporary_.c_str()) != 0 || std::rename(previous.c_str(), target_.c_str()) != 0 ||
        std::rename(temporary_.c_str(), previous.c_str()) != 0)
        fail("can't write", errno);
}

/// Syncs the folder, which stores the file's name. Some file systems do this on their own and refuse the call.
void OutputFile::sync_folder() const
{
    const int folder = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;  // the folder is writable but not readable
    const bool failed = fsync(folder) != 0 && errno == EIO;
    close(folder);
    if (failed) fail("can't write", EIO);
}

void OutputFile::fail(const std::string& what, int error) const
{
    throw Error(name_, "", fmt::format("{}: {}", what, std::generic_category().message(error)));
}

}  // namespace fathom
