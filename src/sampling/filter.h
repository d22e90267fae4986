#pragma once
#include <cstdint>

#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Sampling of a pixel filter by its inverse cumulative distribution: every sample then has the same weight, and a
/// pixel owns its samples (Ernst, Stamminger, Greiner 2006, "Filter Importance Sampling"). The filters are separable,
/// positive, and end two pixels from the centre (Gaussian, sigma 0.5), 1.65 (Blackman-Harris) or one (tent).
struct FilterTable {
    static constexpr int size = 512;
    /// The left half of the inverse, by the fourth root of the share: filters end softly, and there the inverse is
    /// steep.
    float inverse[size + 1];

    void make_gaussian();
    void make_blackman_harris();
    void make_tent();

    /// Offset from the pixel's centre, for u in [0, 1).
    Float sample(Float u) const
    {
        const Mask right = u >= Float(0.5f);
        const Float share = select(right, Float(1) - u, u) * Float(2);
        const Float x = sqrt(sqrt(share)) * Float(static_cast<float>(size));
        const UInt i = to_uint(min(x, Float(static_cast<float>(size - 1))));
        const Float lo = gather(inverse, i), hi = gather(inverse + 1, i);
        const Float offset = fma(x - to_float(i), hi - lo, lo);
        return select(right, -offset, offset);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
