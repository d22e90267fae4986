// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "fathom/api.h"

namespace fathom {

/// Returns the number of threads that this process can use well: the cores in its affinity mask, limited by the CPU
/// quota of its control groups; at least 1. Functions with a parameter `threads` use this number if it is 0.
FATHOM_API int available_threads();

/// Limits the threads of the whole process during its lifetime: reading files, building BVHs and rendering.
class FATHOM_API ThreadLimit {
public:
    /// Sets the limit.
    ///
    /// threads  Maximum number of threads; 0 selects available_threads(). The limit is lower if the system can't start
    ///          that many threads and two more for progress and checkpoints.
    explicit ThreadLimit(int threads);
    /// Moves the limit to a new owner.
    ThreadLimit(ThreadLimit&&) noexcept;
    /// Ends the limit.
    ~ThreadLimit();

    /// Returns the limit in effect.
    int threads() const { return threads_; }

private:
    struct Control;
    int threads_;
    std::unique_ptr<Control> control_;
};

}  // namespace fathom
