// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "fathom/threads.h"

namespace fathom {

/// The threads of a job, which may be more than there are cores.
class ThreadArena {
public:
    /// threads: RenderSettings::threads
    explicit ThreadArena(int threads)
        : threads_(threads > 0 ? threads : available_threads()),
          limit_(tbb::global_control::max_allowed_parallelism,
                 std::size_t(std::max(threads_, tbb::this_task_arena::max_concurrency()))),
          arena_(threads_)
    {
    }
    int threads() const { return threads_; }
    template <class Work>
    void execute(const Work& work)
    {
        arena_.execute(work);
    }

private:
    int threads_;
    tbb::global_control limit_;
    tbb::task_arena arena_;
};

}  // namespace fathom
