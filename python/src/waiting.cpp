// SPDX-License-Identifier: Apache-2.0
#include "waiting.h"

#include <chrono>
#include <thread>

namespace fathom::python {

namespace nb = nanobind;

namespace {

/// Longest time until a signal is noticed.
constexpr std::chrono::milliseconds signal_interval{50};

}  // namespace

void Waiting::run(const std::function<void()>& work)
{
    std::exception_ptr error;
    {
        const nb::gil_scoped_release release;
        std::thread worker([&] {
            try {
                work();
            } catch (...) {
                error = std::current_exception();
            }
            const std::lock_guard lock(mutex_);
            done_ = true;
            changed_.notify_all();
        });
        handle_events();
        worker.join();
    }
    if (error) std::rethrow_exception(error);
}

void Waiting::handle_events()
{
    std::unique_lock lock(mutex_);
    while (!done_) {
        changed_.wait_for(lock, signal_interval, [&] { return done_ || pass_; });
        const Film* const pass = pass_;
        if (done_) break;
        lock.unlock();
        if (!cancel_) {
            const nb::gil_scoped_acquire acquire;
            try {
                if (PyErr_CheckSignals() != 0) nb::raise_python_error();
                if (pass && on_pass_) on_pass_(*pass);
            } catch (nb::python_error& exception) {
                raised_.emplace(std::move(exception));
                cancel_ = true;
            }
        }
        lock.lock();
        if (!pass) continue;
        pass_ = nullptr;
        changed_.notify_all();
    }
}

void Waiting::announce(const Film& film)
{
    if (!on_pass_ || cancel_) return;
    std::unique_lock lock(mutex_);
    pass_ = &film;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !pass_; });
}

nb::object Waiting::exception() const
{
    return raised_ ? nb::borrow(raised_->value()) : nb::object(nb::none());
}

}  // namespace fathom::python
