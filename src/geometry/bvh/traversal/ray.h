#pragma once
/// Rays made ready for traversal, and what is known of rounding.
///
/// A box must be visited if something in it could be hit. Let M be the largest coordinate of a corner, seen from the
/// ray's origin; M is at most |o| + r, the largest coordinates of the origin and of the tree. In units of 2^-24 M, as
/// displacements in space, the point of the ray at the distance that meet_triangle finds is away from the triangle by:
/// 4 for the sheared coordinates (difference, two roundings of the shear, fma), 5 for the weights (each exact to 3
/// units of relative error, the quotient to 2), 6 for t (the three products, their sum, shear, quotient), less than 16
/// in all. The distance to a plane of a box is computed with errors of 1 for the inverse, 2 for origin times inverse, 2
/// for the fma: less than 8 with that of the slack itself. So boxes are widened by 32 of these units, bvh_slack times
/// |o| + r. Spheres and disks are similar, their boxes widened a little when built.
#include "geometry/bvh/layout/data.h"
#include "geometry/motion.h"
#include "geometry/shapes/shapes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// By how much boxes are widened for a ray.
inline Float ray_slack(const Vec3& o, Float radius)
{
    return Float(bvh_slack) * (max_abs(o) + radius);
}

/// Rays, one per lane: the distance to a plane at x is fma(x, inverse.x, near.x), or far.x, if it is of a box's nearer
/// or farther side.
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

/// As many rays as there are lanes, stored so that each can be read alone: ray i is at f[0] + i, its fields `lanes`
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
    /// octant: the bits of an integer, bit per axis, set where the direction is negative; axis: of an integer, along
    /// which the direction is longest; side: where in BvhNode::bounds the nearer sides begin, by axis; seen: the origin
    /// as triangles are seen from it, along `axis` last; row: integers, which axes the first two of them are.
    alignas(64) float f[field_count][lanes];

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
        // By the sign bit, as safe_inverse: -0 goes down.
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

    /// As they see triangles.
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

/// One of them.
struct PreparedRay {
    const float* p;

    float number(int field) const { return p[field * lanes]; }
    std::uint32_t integer(int field) const { return std::bit_cast<std::uint32_t>(number(field)); }
    Vec3 vector(int field) const { return {Float(number(field)), Float(number(field + 1)), Float(number(field + 2))}; }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
