// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nanobind/nanobind.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>

#include "fathom/render.h"

namespace fathom::python {

/// Runs work on a thread of its own, while the calling thread handles signals of Python and calls its callbacks.
/// Python's interpreter lock is released in between.
class Waiting {
public:
    using OnPass = std::function<void(const Film&)>;

    /// on_pass  called on the calling thread, with the interpreter lock, for passes that the work announces; may be
    /// empty
    explicit Waiting(OnPass on_pass) : on_pass_(std::move(on_pass)) {}

    /// Runs the work to its end, and throws what it throws. The interpreter lock must be held.
    void run(const std::function<void()>& work);
    /// For the work: announces a pass, and waits until on_pass has returned.
    void announce(const Film& film);
    /// For the work: becomes true when a signal or a callback raised an exception.
    const std::atomic<bool>& cancel() const { return cancel_; }
    /// The exception that a signal or a callback raised; none if there was none.
    nanobind::object exception() const;

private:
    void handle_events();

    OnPass on_pass_;
    std::atomic<bool> cancel_{false};
    std::optional<nanobind::python_error> raised_;
    std::mutex mutex_;
    std::condition_variable changed_;
    bool done_ = false;
    const Film* pass_ = nullptr;  ///< the film of an announced pass that on_pass has not seen yet
};

}  // namespace fathom::python
