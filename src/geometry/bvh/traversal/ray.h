// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Prepared rays, and the error bounds of traversal.
///
/// A box must be visited if something in it could be hit. Let M be the largest coordinate of a vertex relative to the
/// ray's origin; M is at most |o| + r, the largest coordinates of the origin and of the tree. Errors are stated in
/// units of 2^-24 M, as displacements in space. The point at the distance that triangle_distance() computes deviates
/// from the triangle by 4 for the sheared coordinates (difference, two roundings of the shear, fma), 5 for the weights
/// (each exact to 3 units of relative error, the quotient to 2) and 6 for t (the three products, their sum, shear,
/// quotient): less than 16 in all. The distance to a plane of a box has errors of 1 for the inverse, 2 for origin times
/// inverse and 2 for the fma: less than 8, including that of the slack itself. So boxes are widened by 32 units, which
/// is bvh_slack times |o| + r. Spheres and disks behave similarly; their boxes are enlarged at construction.
#include "geometry/bvh/layout/data.h"
#include "geometry/motion.h"
#include "geometry/shapes/shapes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Distance by which boxes are widened for a ray.
inline Float ray_slack(const Vec3& o, Float radius)
{
    return Float(bvh_slack) * (max_abs(o) + radius);
}

/// Rays prepared for box tests, one per lane. The distance to a plane at x is fma(x, inverse.x, near.x) for a near side
/// and fma(x, inverse.x, far.x) for a far side.
struct BoxRays {
    Vec3 inverse, near, far;

    BoxRays() = default;
    BoxRays(const Vec3& o, const Vec3& d, Float radius) : inverse(safe_inverse(d))
    {
        const Float slack = ray_slack(o, radius);
        const auto offset = [&](Float x, Float dx, Float ix, Float sign) {
            return -((x + sign * copysign(slack, dx)) * ix);
        };
        near = {offset(o.x, d.x, inverse.x, Float(1)), offset(o.y, d.y, inverse.y, Float(1)),
                offset(o.z, d.z, inverse.z, Float(1))};
        far = {offset(o.x, d.x, inverse.x, Float(-1)), offset(o.y, d.y, inverse.y, Float(-1)),
               offset(o.z, d.z, inverse.z, Float(-1))};
    }
};

/// Prepared rays, one per lane, stored so that each can be read alone: ray i starts at f[0] + i; its fields are `lanes`
/// apart.
struct PreparedRays {
    enum Field {
        inverse_x,
        inverse_y,
        inverse_z,
        near_x,
        near_y,
        near_z,
        far_x,
        far_y,
        far_z,
        origin_x,
        origin_y,
        origin_z,
        direction_x,
        direction_y,
        direction_z,
        shear_x,
        shear_y,
        shear_z,
        t_max,
        time,
        octant,
        axis,
        side_x,
        side_y,
        side_z,
        seen_x,
        seen_y,
        seen_z,
        row_x,
        row_y,
        field_count
    };
    /// octant: integer bits, one per axis, set if the direction is negative. axis: integer, the longest axis of the
    /// direction. side: offsets of the near planes in BvhNode::bounds, by axis. seen: the origin permuted so that
    /// `axis` is last. row: integers, the first two axes of that permutation.
    alignas(64) float f[field_count][lanes];

    /// Prepares rays for a tree with this radius, the largest absolute coordinate in it.
    void prepare(const Vec3& o, const Vec3& d, Float ray_t_max, Float ray_time, Float radius)
    {
        const BoxRays box(o, d, radius);
        const TriangleRay shear(Ray{o, d, ray_t_max, ray_time});
        const auto set = [&](int field, const Vec3& v) {
            store(f[field], v.x), store(f[field + 1], v.y), store(f[field + 2], v.z);
        };
        set(inverse_x, box.inverse);
        set(near_x, box.near);
        set(far_x, box.far);
        set(origin_x, o);
        set(direction_x, d);
        set(shear_x, {shear.shear_x, shear.shear_y, shear.shear_z});
        store(f[t_max], ray_t_max);
        store(f[time], ray_time);
        // The sign bit decides, as in safe_inverse(): -0 counts as negative.
        const UInt x = float_bits(d.x) >> 31, y = float_bits(d.y) >> 31, z = float_bits(d.z) >> 31;
        constexpr std::uint32_t row = bvh_width;
        store(f[side_x], bits_float(x * UInt(3 * row)));
        store(f[side_y], bits_float(y * UInt(3 * row) + UInt(row)));
        store(f[side_z], bits_float(z * UInt(3 * row) + UInt(2 * row)));
        store(f[octant], bits_float(x | y << 1 | z << 2));
        const auto by_axis = [&](auto along_x, auto along_y, auto along_z) {
            return select(shear.x_major, along_x, select(shear.y_major, along_y, along_z));
        };
        store(f[axis], bits_float(by_axis(UInt(0u), UInt(1u), UInt(2u))));
        set(seen_x, {by_axis(o.y, o.z, o.x), by_axis(o.z, o.x, o.y), by_axis(o.x, o.y, o.z)});
        store(f[row_x], bits_float(by_axis(UInt(1u), UInt(2u), UInt(0u))));
        store(f[row_y], bits_float(by_axis(UInt(2u), UInt(0u), UInt(1u))));
    }

    /// The rays prepared for triangle tests.
    TriangleRay triangle_ray() const
    {
        const UInt major = float_bits(load(f[axis]));
        return {load_vec3(f[origin_x], f[origin_y], f[origin_z]),
                major == UInt(0u),
                major == UInt(1u),
                load(f[shear_x]),
                load(f[shear_y]),
                load(f[shear_z])};
    }
};

/// A single ray of PreparedRays.
struct PreparedRay {
    const float* p;

    float number(int field) const { return p[field * lanes]; }
    std::uint32_t integer(int field) const { return std::bit_cast<std::uint32_t>(number(field)); }
    Vec3 vector(int field) const { return {Float(number(field)), Float(number(field + 1)), Float(number(field + 2))}; }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
