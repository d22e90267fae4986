#pragma once
#include <memory>

#include "fathom/api.h"

namespace fathom {

/// Threads that this process makes good use of: one for each core that it may run on, no more than its container may
/// use the time of. What `threads = 0` means.
FATHOM_API int available_threads();

/// As long as it lives, nothing in this process takes more threads than these: neither reading files nor building trees
/// nor rendering.
class FATHOM_API ThreadLimit {
public:
    /// threads  0: available_threads(). Fewer if the system does not let so many, and two for other work, be started.
    explicit ThreadLimit(int threads);
    ThreadLimit(ThreadLimit&&) noexcept;
    ~ThreadLimit();

    int threads() const { return threads_; }

private:
    struct Control;
    int threads_;
    std::unique_ptr<Control> control_;
};

}  // namespace fathom
