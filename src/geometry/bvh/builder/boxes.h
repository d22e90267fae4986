// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Intersection of one ray with the boxes of a wide node: lanes are children.
#include <cstddef>

#include "geometry/bvh/traversal/push.h"
#include "geometry/bvh/traversal/ray.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A node's bounds as one flat array, because offsets lead from row to row and a pointer into one row must not leave
/// it.
[[gnu::always_inline]] inline const float* planes(const BvhNode& node)
{
    static_assert(offsetof(BvhNode, bounds) == 0);
    return reinterpret_cast<const float*>(&node);
}

/// Entry and exit distances of a ray for all child boxes, limited to [0, t_max].
[[gnu::always_inline]] inline BoxDistances distances_to(const BvhNode& node, const PreparedRay& r, Float t_max)
{
    // side_x, side_y and side_z select the rows of near planes; the rows of far planes are 3 rows away.
    const float* const bounds = planes(node);
    constexpr std::ptrdiff_t row = bvh_width;
    const std::ptrdiff_t x = r.integer(PreparedRays::side_x), y = r.integer(PreparedRays::side_y),
                         z = r.integer(PreparedRays::side_z);
    const Vec3 inverse = r.vector(PreparedRays::inverse_x), near = r.vector(PreparedRays::near_x),
               far = r.vector(PreparedRays::far_x);
    BoxDistances box;
    for (int part = 0; part < box_parts; ++part) {
        const float* const p = bounds + part * lanes;
        const Float near_x = fma(load(p + x), inverse.x, near.x), far_x = fma(load(p + 3 * row - x), inverse.x, far.x);
        const Float near_y = fma(load(p + y), inverse.y, near.y), far_y = fma(load(p + 5 * row - y), inverse.y, far.y);
        const Float near_z = fma(load(p + z), inverse.z, near.z), far_z = fma(load(p + 7 * row - z), inverse.z, far.z);
        box.near[part] = max(max(near_x, near_y), max(near_z, Float(0)));
        box.far[part] = min(min(far_x, far_y), min(far_z, t_max));
    }
    return box;
}

/// distances_to() for moving boxes. time: 0 when the shutter opens, 1 when it closes.
[[gnu::always_inline]] inline BoxDistances distances_to_moving(const BvhNode& node, const PreparedRay& r, Float time,
                                                               Float t_max)
{
    const BvhNode& change = (&node)[1];
    BoxDistances box;
    for (int part = 0; part < box_parts; ++part) {
        box.near[part] = Float(0);
        box.far[part] = t_max;
        for (int axis = 0; axis < 3; ++axis) {
            const std::ptrdiff_t near_row = r.integer(PreparedRays::side_x + axis) + part * lanes;
            const std::ptrdiff_t far_row = (2 * axis + 3) * bvh_width - near_row + 2 * part * lanes;
            const auto plane = [&](std::ptrdiff_t row) {
                return fma(load(planes(change) + row), time, load(planes(node) + row));
            };
            const Float inverse(r.number(PreparedRays::inverse_x + axis));
            const Float near = fma(plane(near_row), inverse, Float(r.number(PreparedRays::near_x + axis)));
            const Float far = fma(plane(far_row), inverse, Float(r.number(PreparedRays::far_x + axis)));
            box.near[part] = max(near, box.near[part]);
            box.far[part] = min(far, box.far[part]);
        }
    }
    return box;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
