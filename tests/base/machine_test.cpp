// SPDX-License-Identifier: Apache-2.0
#include "base/machine.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "fathom/threads.h"

namespace fathom {
namespace {

namespace fs = std::filesystem;

/// Fixture with a fake root folder that holds the files of /proc and /sys with the machine's limits.
class Machine : public ::testing::Test {
protected:
    void SetUp() override
    {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        root_ = fs::temp_directory_path() / (std::string("fathom_machine_") + info->name() + std::to_string(getpid()));
        write("proc/meminfo", "MemTotal:       16000000 kB\nMemAvailable:    8000000 kB\n");
    }
    void TearDown() override { fs::remove_all(root_); }

    void write(const fs::path& file, const std::string& text) const
    {
        fs::create_directories((root_ / file).parent_path());
        std::ofstream(root_ / file) << text;
    }

    fs::path root_;
};

constexpr std::uint64_t gigabyte = 1000000000, free_bytes = 8000000ull * 1024;

TEST_F(Machine, WithoutGroups)
{
    EXPECT_EQ(memory_left(root_), free_bytes);
    EXPECT_EQ(memory_left(root_ / "nowhere"), ~std::uint64_t(0));
}

TEST_F(Machine, MemoryOfTheProcessesOwnGroup)
{
    write("proc/self/cgroup", "0::/user.slice/job\n");
    const fs::path group = "sys/fs/cgroup/user.slice/job";
    write(group / "memory.max", "3000000000\n");
    write(group / "memory.current", "2500000000\n");
    EXPECT_EQ(memory_left(root_), gigabyte / 2);
    // The kernel reclaims inactive page cache, so it counts as free memory.
    write(group / "memory.stat", "anon 1000\ninactive_file 1500000000\nactive_file 7\n");
    EXPECT_EQ(memory_left(root_), 2 * gigabyte);
    write(group / "memory.current", "9000000000\n");
    EXPECT_EQ(memory_left(root_), 0u);
}

TEST_F(Machine, AGroupAboveMayHaveLess)
{
    write("proc/self/cgroup", "0::/user.slice/job/step\n");
    write("sys/fs/cgroup/user.slice/job/step/memory.max", "max\n");
    write("sys/fs/cgroup/user.slice/job/step/memory.current", "5\n");
    write("sys/fs/cgroup/user.slice/memory.max", "1000000000\n");
    write("sys/fs/cgroup/user.slice/memory.current", "0\n");
    EXPECT_EQ(memory_left(root_), gigabyte);
}

TEST_F(Machine, AContainerSeesItsGroupAsTheRoot)
{
    // Inside a container, /proc/self/cgroup may name a path that exists only outside of it.
    for (const char* path : {"0::/\n", "0::/docker/abc\n", "0::/../other\n", ""}) {
        write("proc/self/cgroup", path);
        write("sys/fs/cgroup/memory.max", "1000000000\n");
        write("sys/fs/cgroup/memory.current", "0\n");
        write("sys/fs/cgroup/cpu.max", "100000 100000\n");
        EXPECT_EQ(memory_left(root_), gigabyte) << path;
        EXPECT_EQ(usable_cores(root_), 1) << path;
    }
}

TEST_F(Machine, ADeepGroupIsLimitedByAnyAboveIt)
{
    // Slurm nests control groups: the limit of a job is set two or three levels above the group of its step.
    const fs::path top = "sys/fs/cgroup/system.slice/slurmstepd.scope", job = top / "job_7";
    write("proc/self/cgroup", "0::/system.slice/slurmstepd.scope/job_7/step_0/user/task_0\n");
    write(job / "step_0/user/task_0/memory.current", "100\n");
    write(job / "step_0/user/task_0/memory.max", "max\n");
    write(job / "memory.max", "3000000000\n");
    write(job / "memory.current", "1000000000\n");
    write(top / "job_8/memory.max", "5\n");
    write(job / "cpu.max", "100000 100000\n");
    EXPECT_EQ(memory_left(root_), 2 * gigabyte);
    EXPECT_EQ(usable_cores(root_), 1);
    write(job / "step_0/user/memory.max", "1500000000\n");
    write(job / "step_0/user/memory.current", "500000000\n");
    EXPECT_EQ(memory_left(root_), gigabyte);
}

TEST_F(Machine, ResidentMemory)
{
    EXPECT_EQ(resident_memory(root_), 0u);
    write("proc/self/status", "Name:\tfathom\nVmHWM:\t  9000 kB\nVmRSS:\t  7000 kB\n");
    EXPECT_EQ(resident_memory(root_), 7000u * 1024);
    const std::uint64_t before = resident_memory("/");
    const std::vector<char> touched(std::size_t(64) << 20, 1);
    const std::uint64_t after = resident_memory("/");
    EXPECT_EQ(std::accumulate(touched.begin(), touched.end(), 0u), touched.size());
    EXPECT_GT(after, before + touched.size() / 2);
}

TEST_F(Machine, MemoryOfVersion1)
{
    write("proc/self/cgroup", "5:cpu,cpuacct:/x\n4:memory:/jobs/a\n1:name=systemd:/y\n0::/z\n");
    fs::create_directories(root_ / "sys/fs/cgroup/unified");
    write("sys/fs/cgroup/memory/jobs/a/memory.limit_in_bytes", "9223372036854771712\n");
    write("sys/fs/cgroup/memory/jobs/a/memory.usage_in_bytes", "1000\n");
    EXPECT_EQ(memory_left(root_), free_bytes);
    write("sys/fs/cgroup/memory/jobs/memory.limit_in_bytes", "2000000000\n");
    write("sys/fs/cgroup/memory/jobs/memory.usage_in_bytes", "1500000000\n");
    write("sys/fs/cgroup/memory/jobs/memory.stat", "cache 1\ntotal_inactive_file 500000000\n");
    EXPECT_EQ(memory_left(root_), gigabyte);
}

TEST_F(Machine, CoresOfTheProcess)
{
    cpu_set_t before;
    ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
    EXPECT_EQ(usable_cores(root_), CPU_COUNT(&before));
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++i)
        if (CPU_ISSET(i, &before)) CPU_SET(i, &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(usable_cores(root_), 1);
    sched_setaffinity(0, sizeof before, &before);
}

TEST_F(Machine, CoresOfGroups)
{
    if (usable_cores(root_) < 2) GTEST_SKIP() << "needs at least two cores";
    write("proc/self/cgroup", "0::/a/b\n");
    write("sys/fs/cgroup/a/cpu.max", "max 100000\n");
    EXPECT_GE(usable_cores(root_), 2);
    // Quotas of 1.1 and 1.5 cores round up to two: the part above one core keeps a second thread busy some of the time.
    for (const char* quota : {"110000 100000\n", "150000 100000\n"}) {
        write("sys/fs/cgroup/a/cpu.max", quota);
        EXPECT_EQ(usable_cores(root_), 2);
    }
    write("sys/fs/cgroup/a/b/cpu.max", "5000 100000\n");
    EXPECT_EQ(usable_cores(root_), 1);

    write("proc/self/cgroup", "5:cpu,cpuacct:/x\n");
    write("sys/fs/cgroup/cpu,cpuacct/x/cpu.cfs_quota_us", "-1\n");
    write("sys/fs/cgroup/cpu,cpuacct/x/cpu.cfs_period_us", "100000\n");
    EXPECT_GE(usable_cores(root_), 2);
    write("sys/fs/cgroup/cpu,cpuacct/x/cpu.cfs_quota_us", "70000\n");
    EXPECT_EQ(usable_cores(root_), 1);
}

TEST(Threads, ALimitTakesWhatItIsGiven)
{
    EXPECT_GE(available_threads(), 1);
    EXPECT_EQ(ThreadLimit(3).threads(), 3);
    EXPECT_EQ(ThreadLimit(0).threads(), available_threads());
}

}  // namespace
}  // namespace fathom
