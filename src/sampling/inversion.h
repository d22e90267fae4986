#pragma once
#include "math/lanes.h"

namespace fathom::inline FATHOM_LANES {

/// The interval of a cumulative table of n + 1 ascending values, from table[first] on, that holds x: its number below
/// n.
inline UInt find_interval(const float* table, UInt first, int n, Float x)
{
    UInt lo(0u), size(static_cast<std::uint32_t>(n));
    for (int left = n; left > 1; left = (left + 1) / 2) {
        const UInt half = (size + UInt(1)) >> 1;
        // Halves by rounding up may overlap; never past the end.
        const UInt middle = select(less(lo + half, UInt(static_cast<std::uint32_t>(n))), lo + half,
                                   UInt(static_cast<std::uint32_t>(n - 1)));
        const Mask right = gather(table, first + middle) <= x;
        lo = select(right, middle, lo);
        size = half;
    }
    return lo;
}

}  // namespace fathom::inline FATHOM_LANES
