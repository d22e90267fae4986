// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Scenes of a few dozen primitives as a flat list: every ray is tested against all of them, `lanes` rays at a time.
///
/// Construction makes it fast. Quads that are faces of one box become that box: one slab test for up to six of them,
/// from inside and outside. Primitives on the convex hull of the scene are left out of occlusion tests, since nothing
/// lies beyond them.
#include <vector>

#include "geometry/ray.h"
#include "geometry/shapes/shapes.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Possible end points of shadow rays, which determine what can never block them.
struct ShadowTargets {
    std::vector<Vec3f> places;                ///< positions of lights that are not primitives
    bool infinite = false;                    ///< whether some shadow rays are infinitely long
    std::uint32_t only_primitive = no_index;  ///< set if all shadow rays end on this primitive
};

/// A flat list of primitives, merged into boxes where possible.
struct FlatScene {
    static constexpr std::uint32_t max_primitives = 96;
    /// Most triangles, which are tested one by one: the BVH is faster from about ten on.
    static constexpr std::uint32_t max_triangles = 10;

    /// Up to six axis-aligned rectangles, tested by one slab test. A single rectangle is a box without thickness.
    static constexpr std::uint32_t codes_per_box = 8, no_face = 7;

    struct Box {
        Vec3f lo, hi;
        bool closed = false;
        /// Primitive at each face code, 2 axis + high; no_index where the box is open, and as padding for lookup().
        std::uint32_t faces[16];
    };
    /// An oriented box or parallelepiped: its origin, and vectors for which dot(p - origin, along[axis]) is from 0 to 1
    /// inside.
    struct OrientedBox {
        Vec3f origin, along[3];
        Box unit;  ///< the box in its own coordinates
    };
    /// A parallelogram that is not part of a box.
    struct Quad {
        Vec3f corner, normal, dual_u, dual_v;  ///< u = dot(p - corner, dual_u), and v likewise
        std::uint32_t primitive;
    };
    struct Triangle {
        Vec3f a, b, c;
        std::uint32_t primitive;
    };
    /// A sphere or disk.
    struct Round {
        std::uint32_t index, primitive;  ///< index of a sphere or disk in the tables, and its primitive number
    };
    /// Primitives to test, by kind.
    struct List {
        std::vector<Box> boxes;
        std::vector<OrientedBox> oriented_boxes;
        std::vector<Quad> quads;
        std::vector<Triangle> triangles;
        std::vector<Round> spheres, disks;
        bool only_boxes = false;
    };

    List all;
    /// Primitives that can block a ray between two points of the scene, or between a point and a light inside it.
    List occluders;

    /// Primitive at each face code: eight codes for each box of `all`, then for each oriented box; padded for lookup().
    std::vector<std::uint32_t> face_primitives;
    /// The primitive with a face code of closest_box(), or no_index for no_face.
    UInt primitive_of_code(UInt code) const
    {
        const int n = int(codes_per_box * (all.boxes.size() + all.oriented_boxes.size()));
        return lookup_or_gather(face_primitives.data(), n, code);
    }

    /// Whether a scene can be a flat list: few primitives, no moving vertices, instances, curves or points, and not
    /// editable.
    static bool fits(const GeometryTables& tables);
    /// Builds the lists for the scene's tables.
    void build(const GeometryTables& tables, const ShadowTargets& targets);

    /// The nearest hit of each lane.
    Hit closest(const GeometryTables& tables, const Ray& ray) const;
    /// Lanes of `active` that hit something before t_max.
    Mask occluded(const GeometryTables& tables, const Ray& ray, Mask active) const;

private:
    /// Finds the primitives that can lie between two points of the scene. points: their convex hull contains the scene
    /// and its lights.
    void find_occluders(const GeometryTables& tables, const ShadowTargets& targets, const std::vector<Vec3d>& points,
                        double tolerance);
    // Arguments are passed by value, so that the caller's variables can stay in registers.
    Hit closest_other(const GeometryTables& tables, Ray ray, Hit hit) const;
    void closest_oriented_box(const Ray& ray, Hit& hit) const;
    Mask occluded_by_other(const GeometryTables& tables, Ray ray) const;
};

namespace flat {

/// Distances to the three slabs of a box, and their intersection.
struct Slabs {
    Float t_near, t_far;
    Vec3 near, far;
};

/// Slab test: distances of a ray to the planes of a box. o_inverse: origin times inverse direction.
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

/// Values that the tests of a ray with all boxes share.
struct SlabRay {
    Vec3 inverse, o_inverse;
    UInt entered[3];  ///< by axis: code of the face through which the ray enters a box; flipping bit 0 gives the face
                      ///< through which it leaves

    [[gnu::always_inline]] explicit SlabRay(const Ray& ray) : inverse(safe_inverse(ray.d))
    {
        o_inverse = {ray.o.x * inverse.x, ray.o.y * inverse.y, ray.o.z * inverse.z};
        // Rays in negative direction enter through the high face.
        entered[0] = float_bits(ray.d.x) >> 31;
        entered[1] = (float_bits(ray.d.y) >> 31) | UInt(2u);
        entered[2] = (float_bits(ray.d.z) >> 31) | UInt(4u);
    }
    /// Code of the face through which the ray enters at distance t, which is one of the slab distances `near`.
    [[gnu::always_inline]] UInt face_entered(const Vec3& near, Float t) const
    {
        return select(near.x == t, entered[0], select(near.y == t, entered[1], entered[2]));
    }
    [[gnu::always_inline]] UInt face_left(const Vec3& far, Float t) const { return face_entered(far, t) ^ UInt(1u); }
};

/// Lanes in which the box has the face with this code.
[[gnu::always_inline]] inline Mask has_face(const FlatScene::Box& box, UInt face)
{
    return lookup(box.faces, FlatScene::codes_per_box, face) != UInt(no_index);
}

/// Intersects a box and updates t. code: receives `first` plus the code of the face hit.
[[gnu::always_inline]] inline void closest_box(const FlatScene::Box& box, std::uint32_t first, const SlabRay& ray,
                                               Float& t, UInt& code)
{
    const Slabs s = slabs(box, ray.inverse, ray.o_inverse);
    const Mask meets = (s.t_near <= s.t_far) & (s.t_far > Float(0));
    Mask enters = meets & (s.t_near > Float(0)) & (s.t_near < t);
    if (any(enters)) {
        const UInt face = ray.face_entered(s.near, s.t_near);
        if (!box.closed) enters &= has_face(box, face);
        t = select(enters, s.t_near, t);
        code = select(enters, face + UInt(first), code);
    }
    Mask leaves = meets & !enters & (s.t_far < t);
    if (box.closed) leaves &= s.t_near <= Float(0);
    if (any(leaves)) {
        const UInt face = ray.face_left(s.far, s.t_far);
        if (!box.closed) leaves &= has_face(box, face);
        t = select(leaves, s.t_far, t);
        code = select(leaves, face + UInt(first), code);
    }
}

/// Lanes whose ray hits an existing face of the box at 0 < t < t_max.
[[gnu::always_inline]] inline Mask occluded_box(const FlatScene::Box& box, const SlabRay& ray, Float t_max)
{
    const Slabs s = slabs(box, ray.inverse, ray.o_inverse);
    const Mask meets = (s.t_near <= s.t_far) & (s.t_far > Float(0)) & (s.t_near < t_max);
    if (box.closed) return meets & ((s.t_near > Float(0)) | (s.t_far < t_max));
    if (none(meets)) return meets;
    const Mask enters = (s.t_near > Float(0)) & has_face(box, ray.face_entered(s.near, s.t_near));
    const Mask leaves = (s.t_far < t_max) & has_face(box, ray.face_left(s.far, s.t_far));
    return meets & (enters | leaves);
}

/// Transforms the ray to the box's coordinates without normalizing its direction, so that distances stay equal.
[[gnu::always_inline]] inline Ray seen_from(const FlatScene::OrientedBox& box, const Ray& ray)
{
    const Vec3 o = ray.o - Vec3(box.origin);
    const auto along = [&](const Vec3& v) {
        return Vec3{dot(v, Vec3(box.along[0])), dot(v, Vec3(box.along[1])), dot(v, Vec3(box.along[2]))};
    };
    return {along(o), along(ray.d), ray.t_max, ray.time};
}

/// Lanes whose ray hits the quad at 0 < t < t_max.
[[gnu::always_inline]] inline Mask intersect_quad(const FlatScene::Quad& quad, const Ray& ray, Float t_max, Float& t)
{
    const Vec3 n(quad.normal);
    t = dot(n, Vec3(quad.corner) - ray.o) / dot(n, ray.d);
    const Vec3 p = fma(ray.d, t, ray.o - Vec3(quad.corner));
    const Float u = dot(p, Vec3(quad.dual_u)), v = dot(p, Vec3(quad.dual_v));
    // NaN, for a ray within the plane, fails every comparison.
    return (t > Float(0)) & (t < t_max) & (abs(u - Float(0.5f)) <= Float(0.5f)) & (abs(v - Float(0.5f)) <= Float(0.5f));
}

}  // namespace flat

[[gnu::always_inline]] inline Hit FlatScene::closest(const GeometryTables& tables, const Ray& ray) const
{
    Hit hit{ray.t_max, UInt(no_index), UInt(no_index), Float(0), Float(0)};
    if (!all.boxes.empty()) {
        const flat::SlabRay slab_ray(ray);
        UInt code(no_face);
        std::uint32_t first = 0;
        for (const Box& box : all.boxes) {
            flat::closest_box(box, first, slab_ray, hit.t, code);
            first += codes_per_box;
        }
        hit.primitive = primitive_of_code(code);
    }
    if (!all.only_boxes) return closest_other(tables, ray, hit);
    return hit;
}

[[gnu::always_inline]] inline Mask FlatScene::occluded(const GeometryTables& tables, const Ray& ray, Mask active) const
{
    Mask blocked = Mask(false);
    if (!occluders.boxes.empty()) {
        const flat::SlabRay slab_ray(ray);
        for (const Box& box : occluders.boxes) blocked |= flat::occluded_box(box, slab_ray, ray.t_max);
    }
    if (!occluders.only_boxes) blocked |= occluded_by_other(tables, ray);
    return blocked & active;
}

inline void FlatScene::closest_oriented_box(const Ray& ray, Hit& hit) const
{
    UInt code(no_face);
    auto first = std::uint32_t(codes_per_box * all.boxes.size());
    for (const OrientedBox& box : all.oriented_boxes) {
        flat::closest_box(box.unit, first, flat::SlabRay(flat::seen_from(box, ray)), hit.t, code);
        first += codes_per_box;
    }
    hit.primitive = select(code == UInt(no_face), hit.primitive, primitive_of_code(code));
}

/// The nearer of `hit` and the hits on everything except axis-aligned boxes.
[[gnu::noinline]] inline Hit FlatScene::closest_other(const GeometryTables& tables, Ray ray, Hit hit) const
{
    if (!all.oriented_boxes.empty()) closest_oriented_box(ray, hit);
    for (const Quad& quad : all.quads) {
        Float t;
        const Mask m = flat::intersect_quad(quad, ray, hit.t, t);
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

[[gnu::noinline]] inline Mask FlatScene::occluded_by_other(const GeometryTables& tables, Ray ray) const
{
    Mask blocked = Mask(false);
    for (const OrientedBox& box : occluders.oriented_boxes)
        blocked |= flat::occluded_box(box.unit, flat::SlabRay(flat::seen_from(box, ray)), ray.t_max);
    for (const Quad& quad : occluders.quads) {
        Float t;
        blocked |= flat::intersect_quad(quad, ray, ray.t_max, t);
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
    return blocked;
}

}  // namespace FATHOM_LANES
}  // namespace fathom
