// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Reverses the bits of one number; the scalar counterpart of reverse_bits().
inline std::uint32_t reverse_bits_scalar(std::uint32_t x)
{
    x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    return __builtin_bswap32(x);
}

/// A 32-bit hash with full avalanche, using the constants of Wellons's "lowbias32". U: UInt or std::uint32_t.
template <class U>
U hash(U x)
{
    x = x ^ (x >> 16);
    x = x * U(0x7feb352du);
    x = x ^ (x >> 15);
    x = x * U(0x846ca68bu);
    return x ^ (x >> 16);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
