// SPDX-License-Identifier: Apache-2.0
#include "formats/assimp/subprocess.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/waiting.h"

namespace fathom {
namespace {

constexpr std::size_t memory = std::size_t(256) << 20;
constexpr unsigned long_s = 600;  // seconds; long enough for work that ends by itself on a busy machine

double seconds_of(const std::function<void()>& action)
{
    const auto start = std::chrono::steady_clock::now();
    action();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void sleep_for_ever()
{
    for (;;) pause();
}

TEST(Subprocess, ReturnsTheResult)
{
    const std::string large(5'000'000, 'x');
    const SubprocessResult result = run_in_subprocess([&] { return large; }, long_s, memory);
    EXPECT_EQ(result.failure, "");
    EXPECT_EQ(result.bytes, large);
}

TEST(Subprocess, ReportsCrashes)
{
    EXPECT_EQ(run_in_subprocess([]() -> std::string { std::abort(); }, long_s, memory).failure, "it crashed");
}

TEST(Subprocess, EnforcesMemoryAndTimeLimits)
{
#ifdef FATHOM_ADDRESS_SANITIZER
    GTEST_SKIP() << "the address sanitizer ends a program that is out of memory, where new would throw";
#endif
    EXPECT_EQ(run_in_subprocess([] { return std::string(2 * memory, 'x'); }, long_s, memory).failure,
              "it ran out of memory");
}

TEST(Subprocess, EnforcesTheTimeLimitOfWaitingWork)
{
    SubprocessResult result;
    const double seconds = seconds_of([&] {
        result = run_in_subprocess(
            []() -> std::string {
                sleep_for_ever();
                return "";
            },
            1, memory);
    });
    EXPECT_EQ(result.failure, "it exceeded its time or memory limit");
    EXPECT_GE(seconds, 5) << "CPU time does not measure work that waits";
}

TEST(Subprocess, EndsWithTheProgram)
{
    // The subprocess holds the write end of a pipe; its exit closes it, which shows at the read end.
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t program = fork();
    if (program == 0) {
        close(ends[0]);
        run_in_subprocess(
            [&]() -> std::string {
                [[maybe_unused]] const ssize_t n = write(ends[1], "!", 1);
                sleep_for_ever();
                return "";
            },
            1000, memory);
        _exit(0);
    }
    close(ends[1]);
    char byte = 0;
    ASSERT_EQ(read(ends[0], &byte, 1), 1);
    kill(program, SIGKILL);
    waitpid(program, nullptr, 0);
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    EXPECT_TRUE(test::wait_for([&] { return read(ends[0], &byte, 1) == 0; }));
    close(ends[0]);
}

TEST(Subprocess, SandboxAllowsOnlyReading)
{
    if (prctl(PR_GET_SECCOMP) < 0) GTEST_SKIP() << "this kernel has no seccomp";
    namespace fs = std::filesystem;
    const fs::path folder = fs::temp_directory_path() / ("fathom_apart_" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::ofstream(folder / "a") << "bytes";
    const std::string file = (folder / "a").string();
    const SubprocessResult result = run_in_subprocess(
        [&] {
            std::string did, bytes;
            std::ifstream(file) >> bytes;
            if (bytes == "bytes") did += "read ";
            if (std::ofstream(file)) did += "wrote ";
            if (std::ofstream(file + "2")) did += "created ";
            std::error_code error;
            if (fs::remove(file, error)) did += "removed ";
            if (socket(AF_INET, SOCK_STREAM, 0) >= 0) did += "connected ";
            if (std::system("true") == 0) did += "started ";
            if (kill(getppid(), 0) == 0) did += "harmed ";
            return did;
        },
        long_s, memory);
    EXPECT_EQ(result.failure, "");
    EXPECT_EQ(result.bytes, "read ");
    std::string bytes;
    std::ifstream(folder / "a") >> bytes;
    EXPECT_EQ(bytes, "bytes");
    fs::remove_all(folder);
}

}  // namespace
}  // namespace fathom
