#pragma once
/// Intersection of N rays with one primitive: each updates `hit` where the primitive is nearer, or as near and of lower
/// number.
#include "geometry/ray.h"

namespace fathom::inline FATHOM_LANES {

/// What the watertight triangle test needs of a ray: Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection".
/// The axes are permuted so that z is the largest of |d|, then sheared so that the ray runs along z.
struct TriangleRay {
    Vec3 o;
    Mask x_major, y_major;
    Float shear_x, shear_y, shear_z;

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
    /// (x, y, z) turned cyclically until the major axis is last.
    Vec3 permute(Vec3 v) const
    {
        return {select(x_major, v.y, select(y_major, v.z, v.x)), select(x_major, v.z, select(y_major, v.x, v.y)),
                select(x_major, v.x, select(y_major, v.y, v.z))};
    }
};

/// u and v are the weights of b and c. Edges shared by two triangles are closed: of the two at least one is hit.
inline void closest_triangle(const TriangleRay& ray, Vec3 a, Vec3 b, Vec3 c, UInt primitive, Hit& hit)
{
    const Vec3 pa = ray.permute(a - ray.o), pb = ray.permute(b - ray.o), pc = ray.permute(c - ray.o);
    const Float ax = fma(-ray.shear_x, pa.z, pa.x), ay = fma(-ray.shear_y, pa.z, pa.y);
    const Float bx = fma(-ray.shear_x, pb.z, pb.x), by = fma(-ray.shear_y, pb.z, pb.y);
    const Float cx = fma(-ray.shear_x, pc.z, pc.x), cy = fma(-ray.shear_y, pc.z, pc.y);
    // No fma here: each product must be rounded alike from both sides of an edge. A product that underflows or cancels to
    // 0 counts as on the edge, which closes it.
    const Float u = cx * by - cy * bx;
    const Float v = ax * cy - ay * cx;
    const Float w = bx * ay - by * ax;
    const Mask negative = (u < Float(0)) | (v < Float(0)) | (w < Float(0));
    const Mask positive = (u > Float(0)) | (v > Float(0)) | (w > Float(0));
    const Float det = u + v + w;
    Mask m = (!(negative & positive)) & (det != Float(0));
    if (none(m)) return;
    const Float t_scaled = fma(u, pa.z, fma(v, pb.z, w * pc.z)) * ray.shear_z;
    const Float inverse = Float(1) / det;
    const Float t = t_scaled * inverse;
    m &= (t > Float(0)) & ((t < hit.t) | ((t == hit.t) & less(primitive, hit.primitive)));
    hit.t = select(m, t, hit.t);
    hit.primitive = select(m, primitive, hit.primitive);
    hit.instance = select(m, UInt(no_index), hit.instance);
    hit.u = select(m, v * inverse, hit.u);
    hit.v = select(m, w * inverse, hit.v);
}

/// The quadratic is solved about the point of the ray that is nearest to the centre, which keeps its precision for small and
/// far spheres: Haines et al. 2019, "Precision Improvements for Ray/Sphere Intersection".
inline void closest_sphere(const SphereTable& sphere, std::uint32_t primitive, const Ray& ray, Hit& hit)
{
    const Vec3 center = fma(Vec3(sphere.motion), ray.time, Vec3(sphere.center));
    const Vec3 f = ray.o - center;
    const Float b = -dot(f, ray.d);
    const Float r2 = Float(sphere.radius * sphere.radius);
    const Vec3 foot = fma(ray.d, b, f);
    const Float discriminant = r2 - dot(foot, foot);
    const Float root = sqrt(max(discriminant, Float(0)));
    const Float c = dot(f, f) - r2;
    const Float q = b + copysign(root, b);
    const Float t0 = min(c / q, q), t1 = max(c / q, q);
    const Float t = select(t0 > Float(0), t0, t1);
    const Mask m = (discriminant >= Float(0)) & (t > Float(0)) & (t < hit.t);
    hit.t = select(m, t, hit.t);
    hit.primitive = select(m, UInt(primitive), hit.primitive);
    hit.instance = select(m, UInt(no_index), hit.instance);
}

inline void closest_disk(const DiskTable& disk, std::uint32_t primitive, const Ray& ray, Hit& hit)
{
    const Vec3 n(disk.normal), center(disk.center);
    const Float t = dot(n, center - ray.o) / dot(n, ray.d);
    const Vec3 p = fma(ray.d, t, ray.o - center);
    const Mask m = (t > Float(0)) & (t < hit.t) & (dot(p, p) <= Float(disk.radius * disk.radius));
    hit.t = select(m, t, hit.t);
    hit.primitive = select(m, UInt(primitive), hit.primitive);
    hit.instance = select(m, UInt(no_index), hit.instance);
}

}  // namespace fathom::inline FATHOM_LANES
