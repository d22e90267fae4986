// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <functional>

#include "base/output_file.h"
#include "fathom/error.h"
#include "image/pictures.h"
#include "support/error_message.h"
#include "support/file_size_limit.h"

namespace {

/// Replaces the random part of temporary names, if set.
const std::uint64_t* foreseen = nullptr;
/// Simulates file systems without O_TMPFILE, such as NFS.
bool without_nameless_files = false;

/// Arguments of each call of fsync, in order: the size of the file, or -1 for a folder.
std::vector<off_t> synced;

}  // namespace

/// Overrides the C library's fsync to record what was synced.
extern "C" int fsync(int descriptor)
{
    struct stat status{};
    if (fstat(descriptor, &status) == 0) synced.push_back(S_ISDIR(status.st_mode) ? -1 : status.st_size);
    return int(syscall(SYS_fsync, descriptor));
}

extern "C" ssize_t getrandom(void* to, std::size_t size, unsigned flags)
{
    if (!foreseen) return syscall(SYS_getrandom, to, size, flags);
    std::memcpy(to, foreseen, std::min(size, sizeof *foreseen));
    return ssize_t(size);
}

extern "C" int open(const char* path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    const auto mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    if (without_nameless_files && (flags & O_TMPFILE) == O_TMPFILE) {
        errno = EOPNOTSUPP;
        return -1;
    }
    return int(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

namespace fathom {
namespace {

namespace fs = std::filesystem;
using test::error_message;
using test::make_test_image;
using test::TemporaryFolder;

TEST(CheckOutput, KnowsFormatsFoldersAndSizes)
{
    const TemporaryFolder folder;
    for (const char* name : {"a.exr", "a.PNG", "a.jpg", "a.jpeg", "a.webp", "a.avif", "a.hdr"})
        EXPECT_NO_THROW(check_output(folder.path() / name));
    EXPECT_EQ(folder.files(), 0u);
    for (const char* name : {"a.bmp", "a", "a.tiff", ".png"})
        EXPECT_THROW(check_output(folder.path() / name), Error) << name;
    EXPECT_THROW(check_output(folder.path() / "none" / "a.png"), Error);
    fs::create_directory(folder.path() / "folder.png");
    EXPECT_THROW(check_output(folder.path() / "folder.png"), Error);
    EXPECT_THROW(check_output(folder.path() / "a.jpg", 70000, 1), Error);
    EXPECT_THROW(check_output(folder.path() / "a.webp", 1, 16384), Error);
    EXPECT_THROW(check_output(folder.path() / "a.avif", 1, 16385), Error);
    EXPECT_NO_THROW(check_output(folder.path() / "a.exr", 70000, 1));
    EXPECT_THROW(check_output("/proc/a.png"), Error);
}

TEST(CheckOutput, RefusesAFolderWithoutTheRightToWrite)
{
    if (geteuid() == 0) GTEST_SKIP() << "root can write everywhere";
    const TemporaryFolder folder;
    chmod(folder.path().c_str(), 0500);
    EXPECT_THROW(check_output(folder.path() / "a.png"), Error);
    chmod(folder.path().c_str(), 0700);
}

TEST(CheckOutput, RefusesAFileThatMayNotBeWritten)
{
    if (geteuid() == 0) GTEST_SKIP() << "root may write everything";
    const TemporaryFolder folder;
    write_image(folder.path() / "a.png", make_test_image(4, 4), {});
    chmod((folder.path() / "a.png").c_str(), 0400);
    EXPECT_THROW(check_output(folder.path() / "a.png"), Error);
}

TEST(CheckOutput, RefusesDevicesAndPipes)
{
    const TemporaryFolder folder;
    const fs::path pipe = folder.path() / "pipe.png", link = folder.path() / "link.png";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    fs::create_symlink("pipe.png", link);
    for (const fs::path& file : {pipe, link})
        EXPECT_EQ(error_message([&] { check_output(file); }), "can't write: this is a device or a pipe, not a file");
    EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(WriteImage, ReplacesAndFollowsLinks)
{
    const TemporaryFolder folder;
    write_image(folder.path() / "a.exr", make_test_image(4, 4), {});
    fs::create_symlink("a.exr", folder.path() / "link.exr");
    write_image(folder.path() / "link.exr", make_test_image(5, 5), {});
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link.exr"));
    EXPECT_EQ(read_image(folder.path() / "a.exr").width, 5);
    EXPECT_EQ(folder.files(), 2u);
}

TEST(WriteImage, KeepsWhoMayReadTheFile)
{
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    write_image(file, make_test_image(4, 4), {});
    for (const mode_t mode : {0600u, 0664u, 0777u}) {
        ASSERT_EQ(chmod(file.c_str(), mode), 0);
        write_image(file, make_test_image(5, 4), {});
        struct stat status{};
        ASSERT_EQ(stat(file.c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 07777, mode);
    }
    if (geteuid() != 0) return;
    ASSERT_EQ(chown(file.c_str(), 54321, 54322), 0);
    write_image(file, make_test_image(4, 4), {});
    struct stat status{};
    ASSERT_EQ(stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, 54321u);
    EXPECT_EQ(status.st_gid, 54322u);
}

TEST(WriteImage, KeepsTheEarlierFileWhenTheDiskIsFull)
{
    const TemporaryFolder folder;
    for (const char* name : {"a.exr", "a.png", "a.jpg", "a.webp", "a.avif", "a.hdr"}) {
        const fs::path file = folder.path() / name;
        write_image(file, make_test_image(4, 4), {});
        const std::vector<char> before = test::bytes_of(file);
        for (rlim_t limit : {0, 100, 5000, 20000}) {
            const std::string message = error_message([&] {
                const test::FileSizeLimit full(limit);
                write_image(file, make_test_image(300, 200), {});
            });
            EXPECT_EQ(message.rfind("can't write: ", 0), 0u) << name << " " << limit << " " << message;
            EXPECT_EQ(test::bytes_of(file), before) << name;
        }
    }
    EXPECT_EQ(folder.files(), 6u);
}

TEST(OutputFile, SyncsTheFileThenItsFolder)
{
    const TemporaryFolder folder;
    synced.clear();
    OutputFile file(folder.path() / "a");
    file.write("12345", 5);
    EXPECT_TRUE(synced.empty());
    file.commit();
    EXPECT_EQ(synced, (std::vector<off_t>{5, -1}));
}

TEST(OutputFile, WritesWholeFilesOfAnySize)
{
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a";
    constexpr std::size_t most = (std::size_t(17) << 20) + 3;
    std::vector<char> bytes(most + 4096);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = char(i * 2654435761u >> 13);
    const auto first = (4096 - std::size_t(reinterpret_cast<std::uintptr_t>(bytes.data()) % 4096)) % 4096;
    for (const std::size_t size : {std::size_t(0), std::size_t(1), std::size_t(4096), std::size_t(8) << 20, most}) {
        OutputFile file(path);
        file.write_whole(bytes.data() + first, size);
        file.commit();
        const std::vector<char> read = test::bytes_of(path);
        ASSERT_EQ(read.size(), size);
        EXPECT_TRUE(std::equal(read.begin(), read.end(), bytes.begin() + std::ptrdiff_t(first)));
    }
}

TEST(OutputFile, KeepsTheEarlierFileUnderAnotherName)
{
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a", previous = folder.path() / "a.previous";
    for (const char* text : {"1", "2", "3"}) {
        OutputFile file(path);
        file.write(text, 1);
        file.commit(previous);
        EXPECT_EQ(test::bytes_of(path)[0], text[0]);
        if (text[0] > '1') EXPECT_EQ(test::bytes_of(previous)[0], char(text[0] - 1));
    }
    EXPECT_EQ(folder.files(), 2u);
}

void write_text(const fs::path& path, const char* text, const fs::path& previous = {})
{
    OutputFile file(path);
    file.write(text, std::strlen(text));
    file.commit(previous);
}
std::string text_of(const fs::path& path)
{
    const std::vector<char> bytes = test::bytes_of(path);
    return {bytes.begin(), bytes.end()};
}

/// Runs each test with O_TMPFILE and without it.
class Names : public ::testing::TestWithParam<bool> {
protected:
    Names() { without_nameless_files = GetParam(); }
    ~Names() override
    {
        without_nameless_files = false;
        foreseen = nullptr;
    }
    const TemporaryFolder folder_;
};
INSTANTIATE_TEST_SUITE_P(OutputFile, Names, ::testing::Bool());

TEST_P(Names, ALinkAtATemporaryNameIsNotFollowed)
{
    const fs::path path = folder_.path() / "a", victim = folder_.path() / "victim";
    write_text(victim, "mine");
    constexpr std::uint64_t number = 0x0123456789abcdef;
    fs::create_symlink("victim", folder_.path() / fmt::format(".a.{:016x}.part", number));
    foreseen = &number;
    EXPECT_EQ(error_message([&] { write_text(path, "new"); }), "can't write: File exists");
    EXPECT_EQ(text_of(victim), "mine");
    EXPECT_FALSE(fs::exists(path));
    foreseen = nullptr;
    write_text(path, "new");
    EXPECT_EQ(text_of(path), "new");
}

TEST_P(Names, ALinkAtTheEarlierFileIsReplaced)
{
    const fs::path path = folder_.path() / "a.exr", previous = folder_.path() / "a.previous.exr",
                   victim = folder_.path() / "victim";
    write_text(victim, "mine");
    write_text(path, "1");
    fs::create_symlink("victim", previous);
    write_text(path, "2", previous);
    EXPECT_EQ(text_of(victim), "mine");
    EXPECT_FALSE(fs::is_symlink(previous));
    EXPECT_EQ(text_of(path) + text_of(previous), "21");
}

TEST(OutputFile, TemporaryNamesCanNotBeForeseen)
{
    without_nameless_files = true;
    const TemporaryFolder folder;
    std::uint64_t ones = 0, zeros = 0;
    for (int i = 0; i < 100; ++i) {
        const OutputFile file(folder.path() / "a");
        const fs::path name = fs::directory_iterator(folder.path())->path().filename();
        ASSERT_EQ(name.string().substr(0, 3), ".a.");
        const std::uint64_t number = std::stoull(name.string().substr(3, 16), nullptr, 16);
        ones |= number, zeros |= ~number;
    }
    without_nameless_files = false;
    EXPECT_EQ(std::popcount(ones & zeros), 64);
    EXPECT_EQ(folder.files(), 0u);
}

/// A world-writable folder with symbolic links planted by another user.
class SharedFolder : public ::testing::Test {
protected:
    void SetUp() override
    {
        if (geteuid() != 0) GTEST_SKIP() << "needs root to create links of another user";
        fs::create_directory(shared_);
        fs::create_directory(own_);
        chmod(shared_.c_str(), 01777);
        write_text(own_ / "victim", "mine");
    }
    static void plant(const fs::path& to, const fs::path& link, uid_t user = 54321)
    {
        fs::create_symlink(to, link);
        ASSERT_EQ(lchown(link.c_str(), user, user), 0);
    }
    std::string refusal(const fs::path& path) const
    {
        return error_message([&] { write_text(path, "new"); });
    }

    const TemporaryFolder folder_;
    const fs::path shared_ = folder_.path() / "shared", own_ = folder_.path() / "own";
};

TEST_F(SharedFolder, AnotherUsersLinkIsRefused)
{
    plant(own_ / "victim", shared_ / "a");
    plant(own_, shared_ / "out");
    plant("a", shared_ / "second");
    plant(own_ / "new", shared_ / "dangling");
    for (const char* path : {"a", "out/victim", "second", "dangling", "out/../own/victim"})
        EXPECT_EQ(refusal(shared_ / path).rfind("can't write: '", 0), 0u) << path;
    for (const mode_t mode : {0777u, 0775u}) {
        chmod(shared_.c_str(), mode);
        EXPECT_NE(refusal(shared_ / "a"), "");
    }
    EXPECT_EQ(text_of(own_ / "victim"), "mine");
    EXPECT_FALSE(fs::exists(own_ / "new"));
}

TEST_F(SharedFolder, OtherLinksAreFollowed)
{
    // Links are followed if the user owns them, if nobody else can write to their folder, or if their owner also owns
    // the folder.
    fs::create_symlink(own_ / "victim", shared_ / "a");
    EXPECT_EQ(refusal(shared_ / "a"), "");
    EXPECT_EQ(text_of(own_ / "victim"), "new");
    plant("../shared", own_ / "way");
    EXPECT_EQ(refusal(own_ / "way/b"), "");
    EXPECT_EQ(text_of(shared_ / "b"), "new");
    ASSERT_EQ(chown(shared_.c_str(), 777, 777), 0);
    plant(own_ / "c", shared_ / "c", 777);
    EXPECT_EQ(refusal(shared_ / "c"), "");
    EXPECT_EQ(text_of(own_ / "c"), "new");
}

TEST(OutputFile, LinksThatLeadInACircleAreRefused)
{
    const TemporaryFolder folder;
    fs::create_symlink("b", folder.path() / "a");
    fs::create_symlink("a", folder.path() / "b");
    EXPECT_EQ(error_message([&] { write_text(folder.path() / "a", "new"); }), "can't write: too many symbolic links");
}

TEST(WriteImage, RefusesWhatIsNoPicture)
{
    const TemporaryFolder folder;
    EXPECT_THROW(write_image(folder.path() / "a.png", Image{}, {}), Error);
    Image image = make_test_image(4, 4);
    image.layers[0].pixels.pop_back();
    EXPECT_THROW(write_image(folder.path() / "a.exr", image, {}), Error);
    EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace fathom
