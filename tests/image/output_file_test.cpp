#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <csignal>
#include <functional>

#include "fathom/error.h"
#include "image/output_file.h"
#include "pictures.h"

namespace {

/// What was synced, in order: the sizes of files, and -1 for a folder.
std::vector<off_t> synced;

}  // namespace

/// Instead of the C library's.
extern "C" int fsync(int descriptor)
{
    struct stat status{};
    if (fstat(descriptor, &status) == 0) synced.push_back(S_ISDIR(status.st_mode) ? -1 : status.st_size);
    return int(syscall(SYS_fsync, descriptor));
}

namespace fathom {
namespace {

namespace fs = std::filesystem;
using test::made_image;
using test::TemporaryFolder;

std::string message_of(const std::function<void()>& action)
{
    try {
        action();
    } catch (const Error& error) {
        return error.message();
    }
    return "";
}

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
    if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    const TemporaryFolder folder;
    chmod(folder.path().c_str(), 0500);
    EXPECT_THROW(check_output(folder.path() / "a.png"), Error);
    chmod(folder.path().c_str(), 0700);
}

TEST(CheckOutput, RefusesAFileThatMayNotBeWritten)
{
    if (geteuid() == 0) GTEST_SKIP() << "root may write everything";
    const TemporaryFolder folder;
    write_image(folder.path() / "a.png", made_image(4, 4), {});
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
        EXPECT_EQ(message_of([&] { check_output(file); }), "can't write: this is a device or a pipe, not a file");
    EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(WriteImage, ReplacesAndFollowsLinks)
{
    const TemporaryFolder folder;
    write_image(folder.path() / "a.exr", made_image(4, 4), {});
    fs::create_symlink("a.exr", folder.path() / "link.exr");
    write_image(folder.path() / "link.exr", made_image(5, 5), {});
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link.exr"));
    EXPECT_EQ(read_image(folder.path() / "a.exr").width, 5);
    EXPECT_EQ(folder.files(), 2u);
}

TEST(WriteImage, KeepsWhoMayReadTheFile)
{
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "a.png";
    write_image(file, made_image(4, 4), {});
    for (const mode_t mode : {0600u, 0664u, 0777u}) {
        ASSERT_EQ(chmod(file.c_str(), mode), 0);
        write_image(file, made_image(5, 4), {});
        struct stat status{};
        ASSERT_EQ(stat(file.c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 07777, mode);
    }
    if (geteuid() != 0) return;
    ASSERT_EQ(chown(file.c_str(), 54321, 54322), 0);
    write_image(file, made_image(4, 4), {});
    struct stat status{};
    ASSERT_EQ(stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_uid, 54321u);
    EXPECT_EQ(status.st_gid, 54322u);
}

TEST(WriteImage, KeepsTheEarlierFileWhenTheDiskIsFull)
{
    // A limit on the size of files stands for a full disk: write() fails in the same places.
    const TemporaryFolder folder;
    for (const char* name : {"a.exr", "a.png", "a.jpg", "a.webp", "a.avif", "a.hdr"}) {
        const fs::path file = folder.path() / name;
        write_image(file, made_image(4, 4), {});
        const std::vector<char> before = test::bytes_of(file);
        rlimit old{};
        getrlimit(RLIMIT_FSIZE, &old);
        const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
        for (rlim_t limit : {0, 100, 5000, 20000}) {
            const rlimit small{limit, old.rlim_max};
            setrlimit(RLIMIT_FSIZE, &small);
            const std::string message = message_of([&] { write_image(file, made_image(300, 200), {}); });
            setrlimit(RLIMIT_FSIZE, &old);
            EXPECT_EQ(message.rfind("can't write: ", 0), 0u) << name << " " << limit << " " << message;
            EXPECT_EQ(test::bytes_of(file), before) << name;
        }
        std::signal(SIGXFSZ, old_handler);
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

TEST(WriteImage, RefusesWhatIsNoPicture)
{
    const TemporaryFolder folder;
    EXPECT_THROW(write_image(folder.path() / "a.png", Image{}, {}), Error);
    Image image = made_image(4, 4);
    image.layers[0].pixels.pop_back();
    EXPECT_THROW(write_image(folder.path() / "a.exr", image, {}), Error);
    EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace fathom
