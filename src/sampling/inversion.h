// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "math/guide.h"
#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Index below n of the interval that contains x, in a cumulative table of n + 1 ascending values that starts at
/// table[first].
inline UInt find_interval(const float* table, UInt first, int n, Float x)
{
    UInt lo(0u), size(static_cast<std::uint32_t>(n));
    for (int left = n; left > 1; left = (left + 1) / 2) {
        const UInt half = (size + UInt(1)) >> 1;
        // Halves of rounded-up size may overlap; the clamp keeps the index inside the table.
        const UInt middle = select(less(lo + half, UInt(static_cast<std::uint32_t>(n))), lo + half,
                                   UInt(static_cast<std::uint32_t>(n - 1)));
        const Mask right = gather(table, first + middle) <= x;
        lo = select(right, middle, lo);
        size = half;
    }
    return lo;
}

/// Interval of a guided cumulative table: its index and the values at its ends.
struct GuidedInterval {
    UInt number;
    Float begin, end;
};

/// Guide entry for x, for a table of n intervals.
inline UInt guide_entry(int n, Float x)
{
    const UInt entry = to_uint(x * Float(float(guide_size(n)))), last(guide_size(n) - 1);
    return select(less(entry, last), entry, last);
}

/// Finds the interval that contains x in table number `table` of several tables of n + 1 values, side by side, with
/// guides from make_guides().
inline GuidedInterval find_guided(const LargeVector<float>& tables, const LargeVector<std::uint32_t>& guides, int n,
                                  UInt table, Float x)
{
    const UInt bounds = gather(guides.data(), table * UInt(guide_size(n)) + guide_entry(n, x));
    const UInt first = table * UInt(std::uint32_t(n) + 1);
    UInt lo = bounds & UInt(0xffff), hi = bounds >> 16;
    for (Mask open = less(lo, hi); any(open); open = less(lo, hi)) {
        const UInt middle = (lo + hi + UInt(1u)) >> 1;
        const Mask right = gather(tables.data(), first + middle) <= x;
        lo = select(open & right, middle, lo);
        hi = select(open & !right, middle - UInt(1u), hi);
    }
    return {lo, gather(tables.data(), first + lo), gather(tables.data() + 1, first + lo)};
}

}  // namespace FATHOM_LANES
}  // namespace fathom
