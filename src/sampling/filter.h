// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "math/lanes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Pixel filter sampled by its inverse cumulative distribution. All samples have equal weight, and a sample contributes
/// to one pixel only (Ernst, Stamminger and Greiner 2006, "Filter Importance Sampling"). Filters are separable and
/// nonnegative. Their radius in pixels is 2 (Gaussian, sigma 0.5), 1.65 (Blackman-Harris) or 1 (tent).
struct FilterTable {
    static constexpr int size = 512;
    /// Left half of the inverse, tabulated over the fourth root of the probability: filters decay smoothly to 0, where
    /// the inverse is steep.
    float inverse[size + 1];

    /// Fills the table for one of the filters.
    void make_gaussian();
    void make_blackman_harris();
    void make_tent();

    /// Offset from the pixel's center, in pixels, for u in [0, 1).
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
    /// Half width in pixels, and the filter itself, scaled to an integral of 1: its values at even distances up to the
    /// half width.
    float half_width;
    static constexpr int density_size = 1024;
    float density_at[density_size + 1];
    /// Value of the filter at an offset from the pixel's center.
    float density(float offset) const
    {
        const float x = (offset < 0 ? -offset : offset) * (float(density_size) / half_width);
        if (!(x < float(density_size))) return 0;
        const int i = int(x);
        return density_at[i] + (x - float(i)) * (density_at[i + 1] - density_at[i]);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
