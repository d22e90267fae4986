// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>

#include "kernel/lane_scene.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Chooses the pixel that receives light at a point of the image: one of those whose filter covers the point, in
/// proportion to their filters.
class SplatPixel {
public:
    SplatPixel(const LaneScene& scene, const KernelSettings& settings)
        : filter_(settings.filter == 0 ? nullptr : &scene.filters[settings.filter - 1]),
          stretch_(settings.filter_stretch),
          radius_((filter_ ? filter_->half_width : 0.5f) * settings.filter_stretch),
          width_(settings.width),
          height_(settings.height)
    {
    }

    /// Lanes whose point may be within the filter of a pixel.
    Mask may_contain(Float x, Float y) const
    {
        const auto inside = [&](Float at, int size) {
            return (at > Float(-radius_)) & (at < Float(float(size) + radius_));
        };
        return inside(x, width_) & inside(y, height_);
    }

    struct Place {
        bool valid;
        std::uint32_t pixel;  ///< x in the low 16 bits, y above
        float weight;
    };
    /// x, y: in pixels; u, v: uniform random numbers.
    Place choose(float x, float y, float u, float v) const
    {
        const Choice column = choose(x, u), row = choose(y, v);
        const bool valid = column.weight > 0 && row.weight > 0 && column.at >= 0 && column.at < width_ && row.at >= 0 &&
                           row.at < height_;
        return {valid, std::uint32_t(row.at) << 16 | std::uint32_t(column.at), column.weight * row.weight};
    }

private:
    struct Choice {
        int at;
        float weight;  ///< sum of the filters of all candidates
    };
    Choice choose(float x, float u) const
    {
        // Without a table the filter is a box.
        const int first = int(std::ceil(x - 0.5f - radius_)), last = int(std::floor(x - 0.5f + radius_));
        constexpr int most = 64;
        float sums[most];
        float sum = 0;
        const int candidates = std::clamp(last - first + 1, 0, most);
        for (int k = 0; k < candidates; ++k) sums[k] = sum += weight(x - 0.5f - float(first + k));
        if (!(sum > 0)) return {int(std::floor(x)), filter_ || stretch_ != 1 ? 0.0f : 1.0f};
        int k = 0;
        while (k + 1 < candidates && sums[k] <= u * sum) ++k;
        return {first + k, sum};
    }
    float weight(float offset) const
    {
        if (!filter_) return std::fabs(offset) <= radius_ ? 1 / stretch_ : 0;
        return filter_->density(offset / stretch_) / stretch_;
    }

    const FilterTable* const filter_;
    const float stretch_, radius_;
    const int width_, height_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
