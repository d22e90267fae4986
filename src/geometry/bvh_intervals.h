#pragma once
/// What is common to rays that keep together: a box or triangle that their intervals rule out, none of them meets.
#include "geometry/bvh_hits.h"

namespace fathom::inline FATHOM_LANES {

/// A stream's rays come in parts of as many as there are lanes.
inline bool holds_any(RayMask rays, int part)
{
    return rays >> part * lanes & ((RayMask(1) << lanes) - 1);
}
inline Mask part_of(RayMask rays, int part)
{
    return mask_from_bits(std::uint32_t(rays >> part * lanes) & std::uint32_t((RayMask(1) << lanes) - 1));
}

/// Those of the rays that have the octant and axis of the first of them.
inline RayMask alike(const PreparedRays* all, RayMask rays)
{
    const int first = std::countr_zero(rays);
    const auto of_first = [&](int field) { return float_bits(Float(all[first / lanes].f[field][first % lanes])); };
    const UInt octant = of_first(PreparedRays::octant), axis = of_first(PreparedRays::axis);
    RayMask same = 0;
    for (int part = 0; part < stream_size / lanes; ++part) {
        const PreparedRays& r = all[part];
        const Mask m = (float_bits(load(r.f[PreparedRays::octant])) == octant) &
                       (float_bits(load(r.f[PreparedRays::axis])) == axis);
        same |= RayMask(mask_bits(m)) << part * lanes;
    }
    return same & rays;
}

/// Of some rays of one octant: inverse directions, and origins, widened by the slack, whose distance is least and
/// greatest; and how far they reach at most.
struct RayIntervals {
    float low_inverse[3], high_inverse[3], near_origin[3], far_origin[3];
    float reach = -1;

    /// Of no rays.
    void begin(std::uint32_t octant)
    {
        for (int axis = 0; axis < 3; ++axis) {
            const bool down = octant >> axis & 1;
            low_inverse[axis] = infinity, high_inverse[axis] = -infinity;
            near_origin[axis] = down ? infinity : -infinity;
            far_origin[axis] = -near_origin[axis];
        }
    }

    /// radius: of the tree.
    void set(const PreparedRays& r, Mask m, std::uint32_t octant, float radius)
    {
        const Vec3 o = load_vec3(r.f[PreparedRays::origin_x], r.f[PreparedRays::origin_y], r.f[PreparedRays::origin_z]);
        const Float outside(infinity), slack = ray_slack(o, radius);
        for (int axis = 0; axis < 3; ++axis) {
            const Float inverse = load(r.f[PreparedRays::inverse_x + axis]);
            const Float x = load(r.f[PreparedRays::origin_x + axis]);
            low_inverse[axis] = least(select(m, inverse, outside));
            high_inverse[axis] = -least(select(m, -inverse, outside));
            const float from = least(select(m, x - slack, outside)), to = -least(select(m, -(x + slack), outside));
            const bool down = octant >> axis & 1;
            near_origin[axis] = down ? from : to;
            far_origin[axis] = down ? to : from;
        }
    }

    void extend(const RayIntervals& other, std::uint32_t octant)
    {
        for (int axis = 0; axis < 3; ++axis) {
            const bool down = octant >> axis & 1;
            low_inverse[axis] = std::min(low_inverse[axis], other.low_inverse[axis]);
            high_inverse[axis] = std::max(high_inverse[axis], other.high_inverse[axis]);
            const auto widen = [](float& x, float y, bool up) { x = up ? std::max(x, y) : std::min(x, y); };
            widen(near_origin[axis], other.near_origin[axis], !down);
            widen(far_origin[axis], other.far_origin[axis], down);
        }
    }

    /// The distances that any of the rays could have to boxes.
    [[gnu::always_inline]] void distances(int axis, Float near_plane, Float far_plane, Float& near, Float& far) const
    {
        const Float lo(low_inverse[axis]), hi(high_inverse[axis]);
        const Float a = near_plane - Float(near_origin[axis]), b = far_plane - Float(far_origin[axis]);
        near = max(near, min(a * lo, a * hi));
        far = min(far, max(b * lo, b * hi));
    }
};

}  // namespace fathom::inline FATHOM_LANES
