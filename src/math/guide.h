#pragma once
/// Guides to cumulative tables: where to look for a number (Chen and Asau 1974, "On Generating Random Variates from an
/// Empirical Distribution").
#include <cstdint>

#include "base/large_memory.h"

namespace fathom {

/// A guide's entry is of 32 bits, with the numbers of two intervals of the table.
inline constexpr std::uint32_t max_guided_intervals = 1u << 16;

/// Entries of the guide to a table of n intervals.
inline std::uint32_t guide_size(int n) { return (std::uint32_t(n) + 3) / 4; }

/// Guides to tables of n + 1 values each, side by side, that ascend from 0 to 1. Entry k of a guide is for numbers of
/// [k, k + 1) / size: the first and, in its upper half, the last of the intervals that may hold them.
inline LargeVector<std::uint32_t> make_guides(const LargeVector<float>& tables, int n)
{
    const std::uint32_t size = guide_size(n);
    const std::size_t count = tables.size() / (std::size_t(n) + 1);
    // A float's product with `size` may be rounded up into the next entry.
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
