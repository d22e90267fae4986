// SPDX-License-Identifier: Apache-2.0
#include "fathom/threads.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "base/machine.h"

namespace fathom {

int startable_threads(int wanted)
{
    std::mutex mutex;
    std::condition_variable changed;
    bool all_tried = false;
    std::vector<std::thread> threads;
    threads.reserve(std::size_t(wanted));
    try {
        while (int(threads.size()) + 1 < wanted)
            threads.emplace_back([&] {
                std::unique_lock lock(mutex);
                changed.wait(lock, [&] { return all_tried; });
            });
    } catch (const std::system_error&) {
        // The system's thread limit was reached; the threads started so far are counted.
    }
    {
        const std::lock_guard lock(mutex);
        all_tried = true;
    }
    changed.notify_all();
    for (std::thread& thread : threads) thread.join();
    return int(threads.size()) + 1;
}

int available_threads()
{
    return usable_cores("/");
}

namespace {

/// The largest pool that can be started beside two other threads: progress display and checkpoint writer. TBB starts
/// its workers lazily, and a failure to start one is fatal.
int pool_threads(int wanted)
{
    constexpr int others = 2;
    return std::max(1, startable_threads(wanted + others) - others);
}

}  // namespace

struct ThreadLimit::Control {
    tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads)
    : threads_(pool_threads(threads > 0 ? threads : available_threads())),
      control_(new Control{{tbb::global_control::max_allowed_parallelism, std::size_t(threads_)}})
{
}
ThreadLimit::ThreadLimit(ThreadLimit&&) noexcept = default;
ThreadLimit::~ThreadLimit() = default;

}  // namespace fathom
