// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Guide tables that narrow the search in a cumulative distribution to a few intervals: Chen and Asau 1974, "On
/// Generating Random Variates from an Empirical Distribution".
#include <cstdint>

#include "base/large_memory.h"

namespace fathom {

/// The largest number of intervals of a guided table: a guide entry holds two interval indices of 16 bits.
inline constexpr std::uint32_t max_guided_intervals = 1u << 16;

/// Number of guide entries of a table with n intervals.
inline std::uint32_t guide_size(int n) { return (std::uint32_t(n) + 3) / 4; }

/// Builds guides for cumulative tables stored side by side, each of n + 1 values that ascend from 0 to 1. Entry k
/// covers x in [k, k + 1) / size: its low 16 bits hold the first interval that may contain x, its high 16 bits the
/// last.
inline LargeVector<std::uint32_t> make_guides(const LargeVector<float>& tables, int n)
{
    const std::uint32_t size = guide_size(n);
    const std::size_t count = tables.size() / (std::size_t(n) + 1);
    // The product of a float with `size` may round up into the next entry; the margin keeps the right interval in the
    // entry.
    constexpr double rounding = 1e-6;
    LargeVector<std::uint32_t> guides(count * size);
    for (std::size_t t = 0; t < count; ++t) {
        const float* table = &tables[t * (std::size_t(n) + 1)];
        std::uint32_t* guide = &guides[t * size];
        int first = 0, last = 0;
        for (std::uint32_t k = 0; k < size; ++k) {
            while (first + 1 < n && table[first + 1] <= double(k) / size * (1 - rounding)) ++first;
            while (last + 1 < n && table[last + 1] <= double(k + 1) / size) ++last;
            guide[k] = std::uint32_t(first) | std::uint32_t(last) << 16;
        }
    }
    return guides;
}

}  // namespace fathom
