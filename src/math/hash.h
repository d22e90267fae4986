#pragma once
#include <cstdint>

#include "math/lanes.h"

namespace fathom::inline FATHOM_LANES {

/// A 32-bit mix with full avalanche (Wellons's "lowbias32" constants).
template <class U>
U hash(U x)
{
    x = x ^ (x >> 16);
    x = x * U(0x7feb352du);
    x = x ^ (x >> 15);
    x = x * U(0x846ca68bu);
    return x ^ (x >> 16);
}

}  // namespace fathom::inline FATHOM_LANES
