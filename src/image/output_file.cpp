#include "image/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <system_error>

#include "fathom/error.h"

namespace fathom {

namespace fs = std::filesystem;

OutputFile::OutputFile(const fs::path& target) : name_(target.string()), target_(target)
{
    std::error_code error;
    // Renaming over a symbolic link would replace the link, not what it points to.
    if (fs::is_symlink(target, error)) {
        const fs::path real = fs::weakly_canonical(target, error);
        if (!error) target_ = real;
    }
    const fs::file_status status = fs::status(target_, error);
    if (fs::is_directory(status)) throw Error(name_, "", "can't write: this is a folder");
    // Nor may a file take the place of a device, nor of what its owner protected.
    if (fs::exists(status) && !fs::is_regular_file(status))
        throw Error(name_, "", "can't write: this is a device or a pipe, not a file");
    if (fs::exists(status) && access(target_.c_str(), W_OK) != 0) fail("can't write", errno);
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    if (!fs::exists(folder, error))
        throw Error(name_, "", fmt::format("can't write: there is no folder '{}'", folder.string()));

    static int count = 0;
    temporary_ = folder / fmt::format(".{}.{}-{}.part", target_.filename().string().substr(0, 200), getpid(), count++);
    int descriptor = -1;
#ifdef O_TMPFILE
    // Its name comes by way of /proc, which a chroot may lack.
    if (access("/proc/self/fd", F_OK) == 0) descriptor = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    nameless_ = descriptor >= 0;
#endif
    // Not every file system has nameless files.
    if (descriptor < 0) descriptor = open(temporary_.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (descriptor < 0) fail("can't write", errno);
    file_ = fdopen(descriptor, "w+b");
    if (!file_) {
        const int reason = errno;
        close(descriptor);
        if (!nameless_) unlink(temporary_.c_str());
        fail("can't write", reason);
    }
    keep_rights();
}

/// Who may read and write the earlier file may do so with the new one. Its owner is only root's to keep.
void OutputFile::keep_rights() const
{
    struct stat before{};
    if (stat(target_.c_str(), &before) != 0) return;
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

std::uint64_t OutputFile::tell()
{
    const off_t position = ftello(file_);
    if (position < 0) fail("can't write", errno);
    return std::uint64_t(position);
}

void OutputFile::seek(std::uint64_t position)
{
    if (fseeko(file_, off_t(position), SEEK_SET) != 0) fail("can't write", errno);
}

void OutputFile::commit()
{
    // The bytes must be on the disk before the name is: after a power cut the name then means a whole file.
    // Some file systems can't sync; that is no failure of writing.
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
    if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail("can't write", errno);
    std::FILE* file = file_;
    file_ = nullptr;
    if (std::fclose(file) != 0) fail("can't write", errno);
}

void OutputFile::fail(const std::string& what, int error) const
{
    throw Error(name_, "", fmt::format("{}: {}", what, std::generic_category().message(error)));
}

}  // namespace fathom
