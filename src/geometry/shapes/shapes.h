// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Intersection of rays (one per lane) with one primitive. Each function updates `hit` where the primitive is nearer,
/// or at equal distance with a lower number.
#include "geometry/ray.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// A ray prepared for the watertight triangle test: Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection".
/// Axes are permuted so that z is the longest axis of d, then sheared so that the ray runs along z.
struct TriangleRay {
    Vec3 o;
    Mask x_major, y_major;
    Float shear_x, shear_y, shear_z;

    TriangleRay(const Vec3& o, Mask x_major, Mask y_major, Float shear_x, Float shear_y, Float shear_z)
        : o(o), x_major(x_major), y_major(y_major), shear_x(shear_x), shear_y(shear_y), shear_z(shear_z)
    {
    }
    explicit TriangleRay(const Ray& ray) : o(ray.o)
    {
        const Float ax = abs(ray.d.x), ay = abs(ray.d.y), az = abs(ray.d.z);
        x_major = (ax > ay) & (ax > az);
        y_major = (!x_major) & (ay > az);
        const Vec3 d = permute(ray.d);
        shear_z = Float(1) / d.z;
        shear_x = d.x * shear_z;
        shear_y = d.y * shear_z;
    }
    /// Rotates (x, y, z) cyclically so that the major axis is last.
    Vec3 permute(Vec3 v) const
    {
        return {select(x_major, v.y, select(y_major, v.z, v.x)), select(x_major, v.z, select(y_major, v.x, v.y)),
                select(x_major, v.x, select(y_major, v.y, v.z))};
    }
    /// The axis that permute() puts at position i.
    UInt permuted(std::uint32_t i) const
    {
        return select(x_major, UInt((i + 1) % 3), select(y_major, UInt((i + 2) % 3), UInt(i)));
    }
};

/// Returns a b - c d with a relative error of at most 2^-23, hence with the right sign: Kahan's algorithm; Jeannerod,
/// Louvet, Muller 2013, "Further analysis of Kahan's algorithm for the accurate computation of 2x2 determinants".
template <class F>
[[gnu::always_inline]] inline F difference_of_products(F a, F b, F c, F d)
{
    const F cd = c * d;
    return fma(a, b, -cd) + fma(-c, d, cd);
}

/// Barycentric weights of the point where a ray passes a triangle, before division by their sum. F: Float, or half of
/// one where Float is a pair.
template <class F>
struct TriangleWeightsOf {
    F a, b, c;
    decltype(a <= b) inside;
};
using TriangleWeights = TriangleWeightsOf<Float>;

/// A triangle corner relative to the ray's origin, permuted as in TriangleRay.
template <class F>
struct TriangleCorner {
    F x, y, z;
};

/// A triangle corner projected along the ray.
template <class F>
struct SeenCorner {
    F x, y;
};

/// Computes the weights for corners that are relative to the ray's origin, permuted as in TriangleRay, and sheared.
///
/// No ray passes between two triangles with a common edge: both use the same rounded corners, the side of the edge is
/// decided exactly, and the edge belongs to both. The weights are accurate enough that the hit point is as close to the
/// triangle as the rounding of corners allows, even for needles and edge-on triangles.
template <class F>
[[gnu::always_inline]] inline TriangleWeightsOf<F> triangle_weights(const SeenCorner<F>& a, const SeenCorner<F>& b,
                                                                    const SeenCorner<F>& c)
{
    TriangleWeightsOf<F> w;
    w.a = difference_of_products(c.x, b.y, c.y, b.x);
    w.b = difference_of_products(a.x, c.y, a.y, c.x);
    w.c = difference_of_products(b.x, a.y, b.y, a.x);
    w.inside = (min(min(w.a, w.b), w.c) >= F(0)) | (max(max(w.a, w.b), w.c) <= F(0));
    return w;
}
/// triangle_weights() for corners that are not sheared yet.
template <class F>
[[gnu::always_inline]] inline TriangleWeightsOf<F> triangle_weights(F shear_x, F shear_y, const TriangleCorner<F>& pa,
                                                                    const TriangleCorner<F>& pb,
                                                                    const TriangleCorner<F>& pc)
{
    const auto sheared = [&](const TriangleCorner<F>& p) {
        return SeenCorner<F>{fma(-shear_x, p.z, p.x), fma(-shear_y, p.z, p.y)};
    };
    return triangle_weights(sheared(pa), sheared(pb), sheared(pc));
}
[[gnu::always_inline]] inline TriangleWeights triangle_weights(Float shear_x, Float shear_y, const Vec3& pa,
                                                               const Vec3& pb, const Vec3& pc)
{
    const auto corner = [](const Vec3& p) { return TriangleCorner<Float>{p.x, p.y, p.z}; };
    return triangle_weights(shear_x, shear_y, corner(pa), corner(pb), corner(pc));
}

/// Distances along a ray to triangles, before division by the sum of the weights.
struct UndividedHits {
    Float t, sum;

    /// z: z coordinates of the corners, permuted as in TriangleRay.
    UndividedHits(const TriangleWeights& w, Float shear_z, const Vec3& z)
        : t(fma(w.a, z.x, fma(w.b, z.y, w.c * z.z)) * shear_z), sum(w.a + w.b + w.c)
    {
    }

    /// Lanes with 0 < t < t_max up to rounding; none where the sum is 0. Avoids the division.
    Mask before(Float t_max) const
    {
        const Float along = flip_sign(t, sum);
        return (along > Float(0)) & (along < t_max * abs(sum));
    }
};

/// Lanes that are inside and have 0 < t <= t_max. z: z coordinates of the corners; u and v receive the weights of b and
/// c.
[[gnu::always_inline]] inline Mask triangle_distance(const TriangleWeights& w, Float shear_z, const Vec3& z,
                                                     Float t_max, Float& t, Float& u, Float& v)
{
    const UndividedHits hits(w, shear_z, z);
    const Float inverse = Float(1) / hits.sum;
    t = hits.t * inverse;
    u = w.b * inverse;
    v = w.c * inverse;
    // NaN, where the sum is 0, fails the comparisons.
    return w.inside & (t > Float(0)) & (t <= t_max);
}

/// Triangles are closed: a ray through a shared edge hits at least one of the two.
inline void closest_triangle(const TriangleRay& ray, Vec3 a, Vec3 b, Vec3 c, UInt primitive, Hit& hit)
{
    const Vec3 pa = ray.permute(a - ray.o), pb = ray.permute(b - ray.o), pc = ray.permute(c - ray.o);
    const TriangleWeights w = triangle_weights(ray.shear_x, ray.shear_y, pa, pb, pc);
    if (none(w.inside)) return;
    Float t, u, v;
    Mask m = triangle_distance(w, ray.shear_z, {pa.z, pb.z, pc.z}, hit.t, t, u, v);
    m &= (t < hit.t) | less(primitive, hit.primitive);
    hit.t = select(m, t, hit.t);
    hit.primitive = select(m, primitive, hit.primitive);
    hit.instance = select(m, UInt(no_index), hit.instance);
    hit.u = select(m, u, hit.u);
    hit.v = select(m, v, hit.v);
}

/// Lanes whose ray (of unit direction) hits the sphere at 0 < t <= t_max; rays from inside hit where they leave.
///
/// The quadratic is solved relative to the point of the ray nearest to the center, which keeps its precision for small
/// and distant spheres: Haines et al. 2019, "Precision Improvements for Ray/Sphere Intersection".
inline Mask intersect_sphere(const Vec3& center, Float radius, const Vec3& o, const Vec3& d, Float t_max, Float& t)
{
    const Vec3 f = o - center;
    const Float b = -dot(f, d);
    const Float r2 = radius * radius;
    const Vec3 foot = fma(d, b, f);
    const Float discriminant = r2 - dot(foot, foot);
    const Float root = sqrt(max(discriminant, Float(0)));
    const Float c = dot(f, f) - r2;
    const Float q = b + copysign(root, b);
    const Float t0 = min(c / q, q), t1 = max(c / q, q);
    t = select(t0 > Float(0), t0, t1);
    return (discriminant >= Float(0)) & (t > Float(0)) & (t <= t_max);
}

/// Updates `hit` with a sphere, which may move linearly.
inline void closest_sphere(const SphereRecord& sphere, std::uint32_t primitive, const Ray& ray, Hit& hit)
{
    const Vec3 center = fma(Vec3(sphere.motion), ray.time, Vec3(sphere.center));
    Float t;
    Mask m = intersect_sphere(center, Float(sphere.radius), ray.o, ray.d, hit.t, t);
    m &= (t < hit.t) | less(UInt(primitive), hit.primitive);
    hit.t = select(m, t, hit.t);
    hit.primitive = select(m, UInt(primitive), hit.primitive);
    hit.instance = select(m, UInt(no_index), hit.instance);
}

/// Lanes whose ray hits the disk at 0 < t <= t_max.
inline Mask intersect_disk(const Vec3& center, const Vec3& n, Float radius, const Vec3& o, const Vec3& d, Float t_max,
                           Float& t)
{
    t = dot(n, center - o) / dot(n, d);
    const Vec3 p = fma(d, t, o - center);
    return (t > Float(0)) & (t <= t_max) & (dot(p, p) <= radius * radius);
}

/// Updates `hit` with a disk.
inline void closest_disk(const DiskRecord& disk, std::uint32_t primitive, const Ray& ray, Hit& hit)
{
    Float t;
    Mask m = intersect_disk(Vec3(disk.center), Vec3(disk.normal), Float(disk.radius), ray.o, ray.d, hit.t, t);
    m &= (t < hit.t) | less(UInt(primitive), hit.primitive);
    hit.t = select(m, t, hit.t);
    hit.primitive = select(m, UInt(primitive), hit.primitive);
    hit.instance = select(m, UInt(no_index), hit.instance);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
