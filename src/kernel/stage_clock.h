// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>

#include "kernel/kernel.h"
#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Counts the paths of a gang (one per lane) that a surface scatters.
[[gnu::always_inline]] inline void count_vertices(KernelCounters& counters, Mask valid)
{
    counters.costs.vertices += std::uint64_t(count(valid));
    counters.costs.shaded_lanes += lanes;
}

/// Measures the time spent in each render stage if enabled; if disabled it costs one branch per call.
class StageClock {
public:
    StageClock(KernelCounters& counters, bool on) : counters_(counters), on_(on), last_(on ? ticks() : 0) {}
    StageClock(const StageClock&) = delete;
    StageClock& operator=(const StageClock&) = delete;
    ~StageClock() { enter(current_); }

    /// Attributes the time from now on to `stage`.
    [[gnu::always_inline]] void enter(RenderStage stage)
    {
        if (!on_) [[likely]]
            return;
        const std::uint64_t now = ticks();
        counters_.ticks[std::size_t(current_)] += now - last_;
        last_ = now;
        current_ = stage;
    }

private:
    /// Time stamp in arbitrary units: see KernelCounters::ticks.
    [[gnu::always_inline]] static std::uint64_t ticks()
    {
#if defined(__x86_64__)
        return __builtin_ia32_rdtsc();
#else
        return std::uint64_t(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
    }

    KernelCounters& counters_;
    const bool on_;
    RenderStage current_ = RenderStage::camera;
    std::uint64_t last_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
