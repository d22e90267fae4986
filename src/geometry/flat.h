#pragma once
/// Scenes of a few dozen primitives: every ray is tested against all of them, N rays at a time.
///
/// What makes it fast is done when it is built: parallelograms that are faces of one axis-aligned box become that box (one
/// slab test for up to six of them, from inside and outside), and primitives on the hull of the scene are left out of
/// shadow tests, since nothing lies beyond them.
#include <vector>

#include "geometry/ray.h"
#include "geometry/shapes.h"

namespace fathom::inline FATHOM_LANES {

struct FlatScene {
    static constexpr std::uint32_t max_primitives = 96;

    struct Box {
        Vec3f lo, hi;
        /// By axis: the primitive of the low face, of the high face; no_index where the box is open.
        std::uint32_t faces[6];
        bool closed = false;
    };
    struct Quad {
        Vec3f corner, normal, dual_u, dual_v;  ///< u = dot(p - corner, dual_u)
        std::uint32_t primitive;
    };
    struct Triangle {
        Vec3f a, b, c;
        std::uint32_t primitive;
    };
    struct Round {
        std::uint32_t index, primitive;  ///< of a sphere or disk in the tables
    };
    struct List {
        std::vector<Box> boxes;
        std::vector<Quad> quads;
        std::vector<Triangle> triangles;
        std::vector<Round> spheres, disks;
    };

    List all;
    /// What can block a ray between two points of the scene, or a point and a light inside it.
    List occluders;

    static bool fits(const SceneTables& tables);
    void build(const SceneTables& tables);

    Hit closest(const SceneTables& tables, const Ray& ray) const;
    /// Lanes of `active` that hit something before t_max.
    Mask occluded(const SceneTables& tables, const Ray& ray, Mask active) const;
};

namespace flat {

struct Slabs {
    Float t_near, t_far;
    Vec3 near, far;
};

[[gnu::always_inline]] inline Slabs slabs(const FlatScene::Box& box, const Vec3& inverse, const Vec3& o_inverse)
{
    const Vec3 lo{fma(Float(box.lo.x), inverse.x, -o_inverse.x), fma(Float(box.lo.y), inverse.y, -o_inverse.y),
                  fma(Float(box.lo.z), inverse.z, -o_inverse.z)};
    const Vec3 hi{fma(Float(box.hi.x), inverse.x, -o_inverse.x), fma(Float(box.hi.y), inverse.y, -o_inverse.y),
                  fma(Float(box.hi.z), inverse.z, -o_inverse.z)};
    Slabs s;
    s.near = {min(lo.x, hi.x), min(lo.y, hi.y), min(lo.z, hi.z)};
    s.far = {max(lo.x, hi.x), max(lo.y, hi.y), max(lo.z, hi.z)};
    s.t_near = max(max(s.near.x, s.near.y), s.near.z);
    s.t_far = min(min(s.far.x, s.far.y), s.far.z);
    return s;
}

/// The primitive of the face through which a ray with direction d passes the slab at distance t.
[[gnu::always_inline]] inline UInt face_at(const FlatScene::Box& box, const Vec3& slab_t, Float t, const Vec3& d, bool entering)
{
    // Entering against the axis means the high face; leaving, the low one.
    const auto along = [&](int axis, Float d_axis) {
        const std::uint32_t lo = box.faces[2 * axis], hi = box.faces[2 * axis + 1];
        return select(d_axis < Float(0), UInt(entering ? hi : lo), UInt(entering ? lo : hi));
    };
    return select(slab_t.x == t, along(0, d.x), select(slab_t.y == t, along(1, d.y), along(2, d.z)));
}

[[gnu::always_inline]] inline void closest_box(const FlatScene::Box& box, const Ray& ray, const Vec3& inverse, const Vec3& o_inverse, Hit& hit)
{
    const Slabs s = slabs(box, inverse, o_inverse);
    const Mask meets = (s.t_near <= s.t_far) & (s.t_far > Float(0));
    Mask enters = meets & (s.t_near > Float(0)) & (s.t_near < hit.t);
    if (any(enters)) {
        const UInt face = face_at(box, s.near, s.t_near, ray.d, true);
        if (!box.closed) enters &= face != UInt(no_index);
        hit.t = select(enters, s.t_near, hit.t);
        hit.primitive = select(enters, face, hit.primitive);
    }
    Mask leaves = meets & !enters & (s.t_far < hit.t);
    if (box.closed) leaves &= s.t_near <= Float(0);
    if (any(leaves)) {
        const UInt face = face_at(box, s.far, s.t_far, ray.d, false);
        leaves &= face != UInt(no_index);
        hit.t = select(leaves, s.t_far, hit.t);
        hit.primitive = select(leaves, face, hit.primitive);
    }
}

[[gnu::always_inline]] inline Mask occluded_box(const FlatScene::Box& box, const Ray& ray, const Vec3& inverse, const Vec3& o_inverse)
{
    const Slabs s = slabs(box, inverse, o_inverse);
    const Mask meets = (s.t_near <= s.t_far) & (s.t_far > Float(0)) & (s.t_near < ray.t_max);
    if (box.closed) return meets & ((s.t_near > Float(0)) | (s.t_far < ray.t_max));
    if (none(meets)) return meets;
    const Mask enters = (s.t_near > Float(0)) & (face_at(box, s.near, s.t_near, ray.d, true) != UInt(no_index));
    const Mask leaves = (s.t_far < ray.t_max) & (face_at(box, s.far, s.t_far, ray.d, false) != UInt(no_index));
    return meets & (enters | leaves);
}

[[gnu::always_inline]] inline Mask meet_quad(const FlatScene::Quad& quad, const Ray& ray, Float t_max, Float& t)
{
    const Vec3 n(quad.normal);
    t = dot(n, Vec3(quad.corner) - ray.o) / dot(n, ray.d);
    const Vec3 p = fma(ray.d, t, ray.o - Vec3(quad.corner));
    const Float u = dot(p, Vec3(quad.dual_u)), v = dot(p, Vec3(quad.dual_v));
    // NaN (a ray within the plane) fails every comparison.
    return (t > Float(0)) & (t < t_max) & (abs(u - Float(0.5f)) <= Float(0.5f)) & (abs(v - Float(0.5f)) <= Float(0.5f));
}

}  // namespace flat

[[gnu::always_inline]] inline Hit FlatScene::closest(const SceneTables& tables, const Ray& ray) const
{
    Hit hit{ray.t_max, UInt(no_index), UInt(no_index), Float(0), Float(0)};
    const Vec3 inverse = safe_inverse(ray.d);
    const Vec3 o_inverse{ray.o.x * inverse.x, ray.o.y * inverse.y, ray.o.z * inverse.z};
    for (const Box& box : all.boxes) flat::closest_box(box, ray, inverse, o_inverse, hit);
    for (const Quad& quad : all.quads) {
        Float t;
        const Mask m = flat::meet_quad(quad, ray, hit.t, t);
        hit.t = select(m, t, hit.t);
        hit.primitive = select(m, UInt(quad.primitive), hit.primitive);
    }
    if (!all.triangles.empty()) {
        const TriangleRay shear(ray);
        for (const Triangle& triangle : all.triangles)
            closest_triangle(shear, Vec3(triangle.a), Vec3(triangle.b), Vec3(triangle.c), triangle.primitive, hit);
    }
    for (const Round& round : all.spheres) closest_sphere(tables.spheres[round.index], round.primitive, ray, hit);
    for (const Round& round : all.disks) closest_disk(tables.disks[round.index], round.primitive, ray, hit);
    return hit;
}

[[gnu::always_inline]] inline Mask FlatScene::occluded(const SceneTables& tables, const Ray& ray, Mask active) const
{
    Mask blocked = Mask(false);
    if (!occluders.boxes.empty()) {
        const Vec3 inverse = safe_inverse(ray.d);
        const Vec3 o_inverse{ray.o.x * inverse.x, ray.o.y * inverse.y, ray.o.z * inverse.z};
        for (const Box& box : occluders.boxes) blocked |= flat::occluded_box(box, ray, inverse, o_inverse);
    }
    for (const Quad& quad : occluders.quads) {
        Float t;
        blocked |= flat::meet_quad(quad, ray, ray.t_max, t);
    }
    if (!occluders.triangles.empty() || !occluders.spheres.empty() || !occluders.disks.empty()) {
        Hit hit{ray.t_max, UInt(no_index), UInt(no_index), Float(0), Float(0)};
        const TriangleRay shear(ray);
        for (const Triangle& triangle : occluders.triangles)
            closest_triangle(shear, Vec3(triangle.a), Vec3(triangle.b), Vec3(triangle.c), triangle.primitive, hit);
        for (const Round& round : occluders.spheres)
            closest_sphere(tables.spheres[round.index], round.primitive, ray, hit);
        for (const Round& round : occluders.disks) closest_disk(tables.disks[round.index], round.primitive, ray, hit);
        blocked |= hit.primitive != UInt(no_index);
    }
    return blocked & active;
}

}  // namespace fathom::inline FATHOM_LANES
