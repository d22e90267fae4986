// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <chrono>
#include <ctime>
#include <thread>

/// Tests wait for states and measure CPU time: no test may fail because the machine is slow (docs/testing.md).
namespace fathom::test {

/// CPU time of this process, the sum of all threads.
inline double processor_seconds()
{
    return double(std::clock()) / double(CLOCKS_PER_SEC);
}

/// Waits until the condition holds. Returns false after half an hour, which only ends tests that hang.
template <class Condition>
bool wait_for(const Condition& condition)
{
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(30);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

struct CancelledWork {
    bool is_done;           ///< result of the work: whether it was completed
    double since_cancel_s;  ///< CPU time from the cancellation to the end of the work
};

/// Calls work(cancel), and sets `cancel` after this process has used the given additional CPU time. On a busy machine
/// the work may finish before.
template <class Work>
CancelledWork cancel_after(double processor_s, const Work& work)
{
    std::atomic<bool> cancel = false, has_ended = false;
    double cancelled_s = 0;
    const double begin_s = processor_seconds();
    std::thread canceller([&] {
        while (!has_ended && processor_seconds() - begin_s < processor_s)
            std::this_thread::sleep_for(std::chrono::microseconds(200));
        cancelled_s = processor_seconds();
        cancel = true;
    });
    const bool is_done = work(static_cast<const std::atomic<bool>&>(cancel));
    const double end_s = processor_seconds();
    has_ended = true;
    canceller.join();
    return {is_done, end_s - cancelled_s};
}

}  // namespace fathom::test
