// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interpolation of motion at the time of a ray, shared by BVH, surfaces and intersection tests, which therefore agree
/// bitwise.
#include "geometry/records.h"
#include "math/elementary.h"
#include "math/gather_member.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Index of the last time that is not after `time`, and the fraction of the way to the next, in [0, 1].
struct KeyTime {
    UInt key;
    Float fraction;
};

/// Position of `time` among tables.vertex_times.
inline KeyTime vertex_key(const GeometryTables& tables, Float time)
{
    const std::vector<float>& times = tables.vertex_times;
    KeyTime k{UInt(0u), Float(0)};
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
        const Mask past = time >= Float(times[i]);
        k.key = select(past, UInt(std::uint32_t(i)), k.key);
        const Float length(1 / (times[i + 1] - times[i]));
        k.fraction = select(past, min((time - Float(times[i])) * length, Float(1)), k.fraction);
    }
    return k;
}

/// Linear interpolation: a at fraction 0, b at 1.
inline Float mix(Float a, Float b, Float fraction)
{
    return fma(b - a, fraction, a);
}
inline Vec3 mix(const Vec3& a, const Vec3& b, Float fraction)
{
    return fma(b - a, fraction, a);
}

/// An affine map, by rows.
struct Affine {
    Vec3 row[3], shift;

    Vec3 vector(const Vec3& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
    Vec3 point(const Vec3& p) const
    {
        const auto at = [&](const Vec3& r, Float s) { return fma(r.x, p.x, fma(r.y, p.y, fma(r.z, p.z, s))); };
        return {at(row[0], shift.x), at(row[1], shift.y), at(row[2], shift.z)};
    }
    /// Applies the transpose: transforms normals by the inverse of this map.
    Vec3 transposed_vector(const Vec3& n) const { return fma(row[0], n.x, fma(row[1], n.y, row[2] * n.z)); }
    /// Sums of the magnitudes that point() adds for each coordinate, for error bounds.
    Vec3 reach(const Vec3& p) const
    {
        const Vec3 a = abs(p);
        return Vec3(dot(abs(row[0]), a), dot(abs(row[1]), a), dot(abs(row[2]), a)) + abs(shift);
    }
    Float determinant() const { return dot(row[0], cross(row[1], row[2])); }
    Affine inverse() const
    {
        const Vec3 x = cross(row[1], row[2]), y = cross(row[2], row[0]), z = cross(row[0], row[1]);
        const Float scale = Float(1) / dot(row[0], x);
        Affine a;
        a.row[0] = Vec3(x.x, y.x, z.x) * scale;
        a.row[1] = Vec3(x.y, y.y, z.y) * scale;
        a.row[2] = Vec3(x.z, y.z, z.z) * scale;
        a.shift = -a.vector(shift);
        return a;
    }
};

/// Interpolated render_from_object of a moving instance; constant before the first pose and after the last.
///
/// number: number(i, k) is float k of the instance's pose i.
template <class Number>
Affine pose_at(const Number& number, UInt pose_count, Float time)
{
    constexpr int translation = 1, rotation = 4, stretch = 8, turns = 14, inverse_sine = 15;
    UInt key(0u);
    for (UInt next(1u);; next = next + UInt(1u)) {
        const Mask there = less(next, pose_count);
        if (none(there)) break;
        const Mask past = there & (time >= number(select(there, next, UInt(0u)), 0));
        key = select(past, next, key);
    }
    const UInt next = select(less(key + UInt(1u), pose_count), key + UInt(1u), key);
    const Float begin = number(key, 0), end = number(next, 0);
    const Float f = clamp(select(end > begin, (time - begin) / (end - begin), Float(0)), Float(0), Float(1));
    const auto between = [&](int k) { return mix(number(key, k), number(next, k), f); };

    const Float angle = number(key, turns), scale = number(key, inverse_sine);
    const Mask turning = scale > Float(0);
    const Float wa = select(turning, sincos_2pi((Float(1) - f) * angle).sin * scale, Float(1) - f);
    const Float wb = select(turning, sincos_2pi(f * angle).sin * scale, f);
    Float q[4];
    for (int k = 0; k < 4; ++k) q[k] = fma(number(key, rotation + k), wa, number(next, rotation + k) * wb);
    const Float x = q[0], y = q[1], z = q[2], w = q[3];
    // Rotation matrix of a quaternion that need not be normalized.
    const Float two = Float(2) / fma(x, x, fma(y, y, fma(z, z, w * w)));
    const Vec3 r0{Float(1) - two * fma(y, y, z * z), two * fma(x, y, -(z * w)), two * fma(x, z, y * w)};
    const Vec3 r1{two * fma(x, y, z * w), Float(1) - two * fma(x, x, z * z), two * fma(y, z, -(x * w))};
    const Vec3 r2{two * fma(x, z, -(y * w)), two * fma(y, z, x * w), Float(1) - two * fma(x, x, y * y)};

    const Float xx = between(stretch), xy = between(stretch + 1), xz = between(stretch + 2), yy = between(stretch + 3),
                yz = between(stretch + 4), zz = between(stretch + 5);
    const Vec3 s0{xx, xy, xz}, s1{xy, yy, yz}, s2{xz, yz, zz};
    Affine a;
    const auto times_stretch = [&](const Vec3& r) { return fma(s0, r.x, fma(s1, r.y, s2 * r.z)); };
    a.row[0] = times_stretch(r0);
    a.row[1] = times_stretch(r1);
    a.row[2] = times_stretch(r2);
    a.shift = {between(translation), between(translation + 1), between(translation + 2)};
    return a;
}

/// render_from_object in each lane of the mask. poses: words with the layout of InstanceRecord::poses.
inline Affine pose_of(const GeometryTables& tables, UInt poses, Float time, Mask m)
{
    const UInt count = poses & UInt(255u), first = poses >> 8;
    const float* table = &tables.poses[0].time;
    const auto number = [&](UInt i, int k) { return gather(table + k, (first + i) << 4, m); };
    return pose_at(number, select(m, count, UInt(0u)), time);
}

/// object_from_render of one instance, for rays in all lanes.
inline Affine object_from_render(const GeometryTables& tables, const InstanceRecord& instance, Float time)
{
    if (instance.pose_count() == 0) {
        const auto& m = instance.object_from_render;
        const auto row = [&](std::size_t i) { return Vec3(Float(m[i]), Float(m[i + 1]), Float(m[i + 2])); };
        return {{row(0), row(4), row(8)}, {Float(m[3]), Float(m[7]), Float(m[11])}};
    }
    const float* poses = &tables.poses[instance.first_pose()].time;
    const auto number = [&](UInt i, int k) { return gather(poses + k, i << 4); };
    return pose_at(number, UInt(instance.pose_count()), time).inverse();
}

/// object_from_render of one instance per lane of the mask.
inline Affine object_from_render(const GeometryTables& tables, UInt instance, Float time, Mask m)
{
    const float* base = reinterpret_cast<const float*>(tables.instances.data());
    const UInt at = instance << 4;
    const auto number = [&](int i) { return gather(base + i, at, m); };
    const auto row = [&](int i) { return Vec3(number(i), number(i + 1), number(i + 2)); };
    Affine a{{row(0), row(4), row(8)}, {number(3), number(7), number(11)}};
    if (tables.poses.empty()) return a;
    const UInt word = gather(tables.instances, &InstanceRecord::poses, instance, m);
    const Mask moving = m & ((word & UInt(255u)) != UInt(0u));
    if (none(moving)) return a;
    const Affine b = pose_of(tables, word, time, moving).inverse();
    for (int i = 0; i < 3; ++i) a.row[i] = select(moving, b.row[i], a.row[i]);
    a.shift = select(moving, b.shift, a.shift);
    return a;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
