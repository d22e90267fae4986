// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <queue>
#include <random>

#include "distributed/ranks/dispatcher.h"
#include "distributed/ranks/environment.h"
#include "distributed/ranks/machines.h"
#include "options/sample_plan.h"

using namespace fathom;
using namespace fathom::cli;

namespace {

/// A simulation of ranks of given speeds, with a clock of its own.
struct Simulation {
    std::vector<SampleRange> rendered;
    std::vector<double> ends_s;
    std::size_t questions = 0;

    Simulation(Dispatcher& dispatcher, const std::vector<double>& sample_s, double start_s = 0)
        : ends_s(sample_s.size(), start_s)
    {
        using Event = std::pair<double, std::size_t>;
        std::priority_queue<Event, std::vector<Event>, std::greater<>> asking;
        std::vector<double> told(sample_s.size());
        for (std::size_t rank = 0; rank < sample_s.size(); ++rank) asking.emplace(start_s, rank);
        while (!asking.empty()) {
            const auto [now_s, rank] = asking.top();
            asking.pop();
            ++questions;
            const std::optional<SampleRange> range = dispatcher.next(int(rank), told[rank], now_s);
            if (!range) continue;
            rendered.push_back(*range);
            told[rank] = sample_s[rank];
            ends_s[rank] = now_s + sample_s[rank] * double(range->second - range->first);
            asking.emplace(ends_s[rank], rank);
        }
    }

    /// The rendered ranges, sorted, and joined where they touch; empty if two overlap.
    std::vector<SampleRange> joined() const
    {
        std::vector<SampleRange> sorted = rendered, all;
        std::sort(sorted.begin(), sorted.end());
        for (const SampleRange& range : sorted) {
            if (!all.empty() && range.first < all.back().second) return {};
            if (!all.empty() && range.first == all.back().second)
                all.back().second = range.second;
            else
                all.push_back(range);
        }
        return all;
    }
    double end_s() const { return *std::max_element(ends_s.begin(), ends_s.end()); }
};

using Ranges = std::vector<SampleRange>;

TEST(Dispatcher, HandsOutEachSampleOnceWithAlmostNobodyIdle)
{
    std::mt19937 random(7);
    for (int trial = 0; trial < 200; ++trial) {
        const int count = 1 + int(random() % 12);
        std::vector<double> sample_s;
        double speed = 0, slowest_s = 0, fastest_s = 1e9;
        for (int i = 0; i < count; ++i) {
            sample_s.push_back(0.02 * std::exp2(double(random() % 600) / 100));
            speed += 1 / sample_s.back();
            slowest_s = std::max(slowest_s, sample_s.back());
            fastest_s = std::min(fastest_s, sample_s.back());
        }
        const Ranges todo = {{3, 40}, {100, 101}, {200, 2200 + random() % 3000}};
        Dispatcher dispatcher(todo, count, {}, true);
        const Simulation run(dispatcher, sample_s);
        EXPECT_EQ(run.joined(), todo);
        // The time is at most that of a perfect division plus a shortest range, or a sample.
        const double best_s = double(count_samples(todo)) / speed;
        EXPECT_LE(run.end_s(), best_s + std::max(0.2, 2 * slowest_s)) << "trial " << trial;
        EXPECT_LE(run.questions, std::size_t(count) * 25) << "trial " << trial;
    }
}

TEST(Dispatcher, DoesNotWaitForASlowRank)
{
    // A sample of the last rank takes as long as two hundred samples of the other ranks.
    const std::vector<double> sample_s = {0.1, 0.1, 0.1, 20};
    Dispatcher dispatcher({{0, 900}}, 4, {}, true);
    const Simulation run(dispatcher, sample_s);
    EXPECT_EQ(run.joined(), (Ranges{{0, 900}}));
    EXPECT_LE(run.end_s(), 31) << "it had one sample, before its speed was known, and gets no other";
    EXPECT_GE(run.end_s(), 20);
}

TEST(Dispatcher, EndsInTime)
{
    const std::vector<double> sample_s = {0.3, 0.11, 0.7};
    Dispatcher dispatcher({{0, max_samples}}, 3, 60.0, true);
    const Simulation run(dispatcher, sample_s, 5);
    ASSERT_EQ(run.joined().size(), 1u) << "without gaps";
    EXPECT_EQ(run.joined()[0].first, 0u);
    for (std::size_t rank = 0; rank < 3; ++rank) {
        EXPECT_LE(run.ends_s[rank], 60) << rank;
        EXPECT_GE(run.ends_s[rank], 60 - sample_s[rank] - 1e-9) << rank;
    }
}

TEST(Dispatcher, HandsOutOneSampleHoweverLate)
{
    Dispatcher late({{0, max_samples}}, 2, 1.0, true);
    EXPECT_EQ(late.next(1, 0, 3.0), (SampleRange{0, 1}));
    EXPECT_EQ(late.next(0, 0, 3.0), std::nullopt);
    Dispatcher enough({{8, max_samples}}, 2, 1.0, false);
    EXPECT_EQ(enough.next(0, 0, 3.0), std::nullopt);
    Dispatcher nothing({}, 2, {}, true);
    EXPECT_EQ(nothing.next(0, 0, 3.0), std::nullopt);
}

RankPlace place(const char* host, const char* cores, int threads, const char* launcher = "")
{
    return {host, cores, launcher, threads};
}

TEST(RankMachines, RanksShareCores)
{
    using Threads = std::vector<int>;
    EXPECT_EQ(assign_threads({place("a", "0-7", 8), place("a", "0-7", 8), place("a", "0-7", 8)}), (Threads{2, 3, 3}));
    EXPECT_EQ(assign_threads({place("a", "0-3", 4), place("a", "4-7", 4)}), (Threads{4, 4})) << "bound to their own";
    EXPECT_EQ(assign_threads({place("a", "0-7", 8), place("b", "0-7", 8)}), (Threads{8, 8})) << "two machines";
    EXPECT_EQ(assign_threads({place("a", "0", 1), place("a", "0", 1)}), (Threads{1, 1})) << "one at least";
    EXPECT_EQ(assign_threads({place("a", "0-63", 4), place("a", "0-63", 4)}), (Threads{2, 2})) << "a container's limit";
    EXPECT_EQ(assign_threads({place("a", "", 4), place("a", "", 4)}), (Threads{2, 2})) << "no cores are told";
}

TEST(RankMachines, ReportsIdleCores)
{
    const std::vector<RankPlace> bound = {place("a", "0", 1, "0-7"), place("a", "1,5", 2, "0-7"),
                                          place("b", "0-1", 2, "0-1")};
    EXPECT_EQ(idle_cores(bound).idle, 5);
    EXPECT_EQ(idle_cores(bound).all, 10);
    EXPECT_EQ(count_machines(bound), 2);
}

TEST(RankMachines, RoundTripAsText)
{
    const RankPlace back = RankPlace::parse(place("node-7.lab", "0-3,8", 5, "0-15").text());
    EXPECT_EQ(back.host, "node-7.lab");
    EXPECT_EQ(back.cores, "0-3,8");
    EXPECT_EQ(back.launcher_cores, "0-15");
    EXPECT_EQ(back.threads, 5);
    EXPECT_FALSE(current_place().host.empty());
    EXPECT_GE(current_place().threads, 1);
}

void clear_environment()
{
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "PMI_SIZE", "PMI_RANK",
                             "SLURM_STEP_NUM_TASKS", "PMIX_RANK", "SLURM_PROCID"})
        unsetenv(name);
}

TEST(RankEnvironment, ReadsWhatLaunchersSay)
{
    const auto ranks = [](const std::map<std::string, std::string>& values) {
        clear_environment();
        for (const auto& [name, value] : values) setenv(name.c_str(), value.c_str(), 1);
        const RankEnvironment found = rank_environment();
        clear_environment();
        return std::pair(found.rank, found.count);
    };
    using Pair = std::pair<int, int>;
    EXPECT_EQ(ranks({}), Pair(0, 1));
    EXPECT_EQ(ranks({{"OMPI_COMM_WORLD_SIZE", "8"}, {"OMPI_COMM_WORLD_RANK", "3"}}), Pair(3, 8));
    EXPECT_EQ(ranks({{"PMI_SIZE", "2"}, {"PMI_RANK", "1"}}), Pair(1, 2));
    EXPECT_EQ(ranks({{"SLURM_STEP_NUM_TASKS", "4"}, {"PMIX_RANK", "2"}}), Pair(2, 4));
    EXPECT_EQ(ranks({{"OMPI_COMM_WORLD_SIZE", "1"}, {"OMPI_COMM_WORLD_RANK", "0"}}), Pair(0, 1)) << "alone";
    EXPECT_EQ(ranks({{"SLURM_STEP_NUM_TASKS", "4"}, {"SLURM_PROCID", "2"}}), Pair(0, 1)) << "srun without MPI";
    EXPECT_EQ(ranks({{"PMI_SIZE", "two"}, {"PMI_RANK", "1"}}), Pair(0, 1));
}

}  // namespace
