// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interval arithmetic over packets of rays: a box or triangle that the intervals exclude is missed by every ray.
#include <algorithm>

#include "geometry/bvh/traversal/hits.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// The rays of a stream are divided in parts of `lanes` rays.
inline bool holds_any(RayMask rays, int part)
{
    return rays >> part * lanes & ((RayMask(1) << lanes) - 1);
}
inline Mask part_of(RayMask rays, int part)
{
    return mask_from_bits(std::uint32_t(rays >> part * lanes) & std::uint32_t((RayMask(1) << lanes) - 1));
}

inline int parts_with(RayMask rays)
{
    int n = 0;
    for (int k = 0; k < stream_size / lanes; ++k) n += holds_any(rays, k);
    return n;
}

/// Whether testing vectors of rays against this many boxes is faster than testing each ray alone against all boxes of a
/// node.
inline bool are_many(RayMask rays, int boxes)
{
    constexpr int tests_alone = 4;  // box tests of one vector that take as long as the node test of a single ray;
                                    // measured
    return tests_alone * std::popcount(rays) >= boxes * parts_with(rays);
}

/// The rays that share octant and longest axis with the first of them.
inline RayMask coherent_rays(const PreparedRays* all, RayMask rays)
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

/// Intervals over rays of one octant: inverse directions, origins widened by the slack, and the largest distance the
/// rays reach.
struct RayIntervals {
    float low_inverse[3], high_inverse[3], near_origin[3], far_origin[3];
    float reach = -1;

    /// Computes intervals for each part of the rays and returns those of all rays. radius: the tree's largest
    /// coordinate.
    template <std::size_t parts, class Part>
    static RayIntervals find(RayIntervals (&of_part)[parts], const Part& part, RayMask rays, std::uint32_t octant,
                             float radius)
    {
        float least[parts][count], of_all[count];
        std::fill_n(of_all, count, infinity);
        for (std::size_t k = 0; k < parts; ++k) {
            find_least(part(int(k)), part_of(rays, int(k)), octant, radius, least[k]);
            for (int i = 0; i < count; ++i) of_all[i] = std::min(of_all[i], least[k][i]);
            of_part[k].set(least[k], octant);
        }
        RayIntervals all;
        all.set(of_all, octant);
        return all;
    }

    /// Narrows [near, far] to the distances that any of the rays could have between a pair of planes.
    [[gnu::always_inline]] void distances(int axis, Float near_plane, Float far_plane, Float& near, Float& far) const
    {
        const Float lo(low_inverse[axis]), hi(high_inverse[axis]);
        const Float a = near_plane - Float(near_origin[axis]), b = far_plane - Float(far_origin[axis]);
        near = max(near, min(a * lo, a * hi));
        far = min(far, max(b * lo, b * hi));
    }

private:
    static constexpr int count = 16;  ///< number of values used below; the last 4 are padding

    /// Writes minimum inverse directions, negated maximum ones, then nearest and farthest origins, by axis; origins are
    /// negated where a maximum is needed.
    static void find_least(const PreparedRays& r, Mask m, std::uint32_t octant, float radius, float (&out)[count])
    {
        const Vec3 o = load_vec3(r.f[PreparedRays::origin_x], r.f[PreparedRays::origin_y], r.f[PreparedRays::origin_z]);
        const Float outside(infinity), slack = ray_slack(o, radius);
        Float x[count];
        for (int axis = 0; axis < 3; ++axis) {
            const Float inverse = load(r.f[PreparedRays::inverse_x + axis]);
            const Float origin = load(r.f[PreparedRays::origin_x + axis]);
            const Float from = select(m, origin - slack, outside), to = select(m, -(origin + slack), outside);
            const bool down = octant >> axis & 1;
            x[axis] = select(m, inverse, outside);
            x[3 + axis] = select(m, -inverse, outside);
            x[6 + axis] = down ? from : to;
            x[9 + axis] = down ? to : from;
        }
        std::fill_n(x + 12, 4, outside);
        reduce_min_each(x, out);
    }
    void set(const float (&least)[count], std::uint32_t octant)
    {
        for (int axis = 0; axis < 3; ++axis) {
            const float down = octant >> axis & 1 ? 1.f : -1.f;
            low_inverse[axis] = least[axis];
            high_inverse[axis] = -least[3 + axis];
            near_origin[axis] = down * least[6 + axis];
            far_origin[axis] = -down * least[9 + axis];
        }
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
