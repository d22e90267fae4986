// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Random rays and scenes for ray casting tests, and brute-force casting that tests every primitive.
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/bvh/builder/leaf_data.h"
#include "geometry/bvh/bvh.h"
#include "geometry/bvh/traversal/ray.h"
#include "geometry/shapes/curve.h"

namespace fathom {

/// PCG (O'Neill 2014) with 32 bits of output.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed * 2862933555777941757u + 3037000493u) { next(); }
    std::uint32_t next()
    {
        const std::uint64_t old = state_;
        state_ = old * 6364136223846793005u + 1442695040888963407u;
        const auto x = std::uint32_t(((old >> 18) ^ old) >> 27), rotation = std::uint32_t(old >> 59);
        return x >> rotation | x << (-rotation & 31);
    }
    float uniform() { return float(next() >> 8) * 0x1p-24f; }
    float uniform(float low, float high) { return low + (high - low) * uniform(); }
    std::uint32_t below(std::uint32_t n) { return std::uint32_t(std::uint64_t(next()) * n >> 32); }
    Vec3f point(float radius) { return {uniform(-radius, radius), uniform(-radius, radius), uniform(-radius, radius)}; }
    Vec3f direction()
    {
        for (;;) {
            const Vec3f d = point(1);
            const float l = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
            if (l > 0.01f && l <= 1) return {d.x / l, d.y / l, d.z / l};
        }
    }

private:
    std::uint64_t state_;
};

/// A random translation and rotation.
inline PoseRecord random_placement(Random& random, float time)
{
    PoseRecord pose;
    pose.time = time;
    const Vec3f p = random.point(60);
    pose.translation[0] = p.x, pose.translation[1] = p.y, pose.translation[2] = p.z;
    float length = 0;
    for (float& q : pose.rotation) q = random.uniform(-1, 1), length += q * q;
    for (float& q : pose.rotation) q /= std::sqrt(length);
    return pose;
}

inline Vec3f plus(Vec3f a, Vec3f b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3f times(Vec3f a, float s)
{
    return {a.x * s, a.y * s, a.z * s};
}
inline Vec3f unit_towards(Vec3f from, Vec3f to)
{
    const double x = double(to.x) - from.x, y = double(to.y) - from.y, z = double(to.z) - from.z;
    const double l = std::sqrt(x * x + y * y + z * z);
    return {float(x / l), float(y / l), float(z / l)};
}

/// Tables with one shape that holds all world-space primitives.
inline GeometryTables empty_tables()
{
    GeometryTables tables;
    tables.shapes.emplace_back();
    return tables;
}
inline void add_triangle(GeometryTables& tables, Vec3f a, Vec3f b, Vec3f c)
{
    for (Vec3f v : {a, b, c}) {
        tables.triangles.push_back(std::uint32_t(tables.positions.size()));
        tables.positions.push_back(v);
    }
}
/// Call it after all primitives were added; instanced meshes already have their ids.
inline void finish(GeometryTables& tables)
{
    if (tables.instances.empty()) tables.world_triangles = tables.triangle_count();
    tables.shape_of_primitive.resize(tables.primitive_count(), 0);
}

struct Rays {
    std::vector<float> o[3], d[3], t_max, time;

    void add(Vec3f origin, Vec3f direction, float limit = std::numeric_limits<float>::infinity(), float at = 0)
    {
        o[0].push_back(origin.x), o[1].push_back(origin.y), o[2].push_back(origin.z);
        d[0].push_back(direction.x), d[1].push_back(direction.y), d[2].push_back(direction.z);
        t_max.push_back(limit), time.push_back(at);
    }
    std::size_t count() const { return padded_ ? count_ : t_max.size(); }
    RayArrays arrays()
    {
        count_ = count();
        padded_ = true;
        for (auto* a : {&o[0], &o[1], &o[2], &d[0], &d[1], &d[2], &t_max, &time})
            a->resize(count_ + 32, a->empty() ? 1 : a->back());
        return {o[0].data(), o[1].data(),  o[2].data(), d[0].data(), d[1].data(),
                d[2].data(), t_max.data(), time.data(), count_};
    }

private:
    std::size_t count_ = 0;  ///< number of rays without padding; set when padding is added
    bool padded_ = false;
};

struct Hits {
    std::vector<float> t, u, v;
    std::vector<std::uint32_t> primitive, instance;

    explicit Hits(std::size_t n) : t(n), u(n), v(n), primitive(n), instance(n) {}
    HitArraysOut arrays() { return {t.data(), u.data(), v.data(), primitive.data(), instance.data()}; }
};

inline Hits cast(const Bvh& bvh, Rays& rays, bool coherent)
{
    const RayArrays arrays = rays.arrays();
    Hits hits(arrays.count);
    bvh.closest(arrays, hits.arrays(), coherent);
    return hits;
}
/// Hash of the first `count` hits; hits before primitive u_end have u, those before v_end v too.
inline std::uint64_t hash_of(const Hits& hits, std::size_t count, std::uint32_t u_end, std::uint32_t v_end)
{
    std::uint64_t hash = 1469598103934665603u;
    const auto mix_in = [&](std::uint32_t x) { hash = (hash ^ x) * 1099511628211u; };
    for (std::size_t i = 0; i < count; ++i) {
        mix_in(std::bit_cast<std::uint32_t>(hits.t[i]));
        mix_in(hits.primitive[i]);
        if (hits.primitive[i] < u_end) mix_in(std::bit_cast<std::uint32_t>(hits.u[i]));
        if (hits.primitive[i] < v_end) mix_in(std::bit_cast<std::uint32_t>(hits.v[i]));
    }
    return hash;
}
inline std::vector<std::uint32_t> cast_shadows(const Bvh& bvh, Rays& rays, bool coherent)
{
    const RayArrays arrays = rays.arrays();
    std::vector<std::uint32_t> blocked(arrays.count);
    bvh.occluded(arrays, blocked.data(), coherent);
    return blocked;
}

/// A vertex of the primitive that the key names, at each lane's time.
inline Vec3 corner_at(const GeometryTables& tables, BvhKey key, int corner, Float time)
{
    Vec3f v[3];
    vertices_of(tables, key, v);
    Vec3 p(v[corner]);
    if (tables.vertex_times.empty() || key / 2 >= tables.first_quad() ||
        tables.shapes[tables.shape_of_primitive[key / 2]].moving_vertices == 0)
        return p;
    const KeyTime at = vertex_key(tables, time);
    for (std::uint32_t k = 0; k + 1 < tables.vertex_times.size(); ++k) {
        Vec3f now[3], then[3];
        vertices_of(tables, key, now, k);
        vertices_of(tables, key, then, k + 1);
        p = select(at.key == UInt(k), mix(Vec3(now[corner]), Vec3(then[corner]), at.fraction), p);
    }
    return p;
}

/// A curve piece at each lane's time.
struct PieceAt {
    CurvePiece piece;
    Vec3 tangent_a, tangent_b;
};
inline PieceAt piece_at(const GeometryTables& tables, std::uint32_t id, Float time)
{
    const ShapeRecord& shape = bvh::shape_of_segment(tables, id >> bvh::piece_bits);
    const auto at_key = [&](std::size_t key) {
        const bvh::PieceEnds e = bvh::piece_ends(tables, id, shape.flags & ShapeRecord::linear_curves, key);
        const auto vector = [](const CurvePoint<float>& p) { return Vec3(Vec3f{p.x, p.y, p.z}); };
        return PieceAt{
            {vector(e.a), vector(e.b), Float(e.a.r), Float(e.b.r)}, vector(e.tangent_a), vector(e.tangent_b)};
    };
    PieceAt p = at_key(0);
    if (shape.moving_vertices == 0) return p;
    const KeyTime at = vertex_key(tables, time);
    for (std::uint32_t k = 0; k + 1 < tables.vertex_times.size(); ++k) {
        const PieceAt now = at_key(k), then = at_key(k + 1);
        const Mask here = at.key == UInt(k);
        const auto between = [&](const auto& a, const auto& b, const auto& old) {
            return select(here, mix(a, b, at.fraction), old);
        };
        p.piece = {between(now.piece.a, then.piece.a, p.piece.a), between(now.piece.b, then.piece.b, p.piece.b),
                   between(now.piece.ra, then.piece.ra, p.piece.ra), between(now.piece.rb, then.piece.rb, p.piece.rb)};
        p.tangent_a = between(now.tangent_a, then.tangent_a, p.tangent_a);
        p.tangent_b = between(now.tangent_b, then.tangent_b, p.tangent_b);
    }
    return p;
}

/// Tests one primitive against rays in world space or, unless instance is no_index, in that instance's object space.
/// scale: length of the object-space direction before normalization.
inline void intersect_brute_force(const GeometryTables& tables, std::uint32_t primitive, const Ray& ray, Float scale,
                                  UInt instance, Hit& hit)
{
    const auto take = [&](Mask m, Float t, Float u, Float v) {
        const Mask first_instance = (hit.primitive == UInt(primitive)) & less(instance, hit.instance);
        m &= (t < hit.t) | ((t == hit.t) & (less(UInt(primitive), hit.primitive) | first_instance));
        hit.t = select(m, t, hit.t);
        hit.u = select(m, u, hit.u);
        hit.v = select(m, v, hit.v);
        hit.primitive = select(m, UInt(primitive), hit.primitive);
        hit.instance = select(m, instance, hit.instance);
    };
    const Float far(infinity);
    Float t;
    if (primitive < tables.first_sphere()) {
        const TriangleRay shear(ray);
        for (BvhKey key = 2 * primitive; key < 2 * primitive + (primitive < tables.first_quad() ? 1 : 2); ++key) {
            const auto corner = [&](int k) { return shear.permute(corner_at(tables, key, k, ray.time) - ray.o); };
            const Vec3 pa = corner(0), pb = corner(1), pc = corner(2);
            const TriangleWeights w = triangle_weights(shear.shear_x, shear.shear_y, pa, pb, pc);
            if (none(w.inside)) continue;
            Float u, v;
            const Mask m = triangle_distance(w, shear.shear_z, {pa.z, pb.z, pc.z}, far, t, u, v);
            take(m, t, key & 1 ? Float(1) - u : u, key & 1 ? Float(1) - v : v);
        }
        return;
    }
    Mask m;
    if (primitive < tables.first_disk()) {
        const SphereRecord& s = tables.spheres[primitive - tables.first_sphere()];
        m = intersect_sphere(fma(Vec3(s.motion), ray.time, Vec3(s.center)), Float(s.radius), ray.o, ray.d, far, t);
    } else if (primitive >= tables.first_point()) {
        const Vec4f& p = tables.points[primitive - tables.first_point()];
        m = Mask(p.w > 0) & intersect_sphere(Vec3(Vec3f{p.x, p.y, p.z}), Float(p.w), ray.o, ray.d, far, t);
    } else if (primitive >= tables.first_curve()) {
        const std::uint32_t segment = primitive - tables.first_curve(),
                            flags = tables.shapes[tables.shape_of_primitive[primitive]].flags;
        const std::uint32_t pieces = tables.curves[segment].pieces;
        for (std::uint32_t piece = 0; piece < pieces; ++piece) {
            const PieceAt at = piece_at(tables, bvh::piece_id(segment, piece), ray.time);
            Float w;
            m = flags & ShapeRecord::ribbons
                    ? intersect_ribbon_piece({at.piece, at.tangent_a, at.tangent_b}, ray.o, ray.d, far, t, w)
                    : intersect_round_piece(at.piece, ray.o, ray.d, far, t, w);
            m &= (at.piece.ra > Float(0)) | (at.piece.rb > Float(0));
            const Float share(1 / float(pieces)), u = fma(w, share, Float(float(piece)) * share);
            t = t * (Float(1) / scale);
            const Mask lower =
                (t == hit.t) & (hit.primitive == UInt(primitive)) & (hit.instance == instance) & (u < hit.u);
            hit.u = select(m & lower, u, hit.u);
            take(m & (t <= hit.t), t, u, Float(0));
        }
        return;
    } else {
        const DiskRecord& d = tables.disks[primitive - tables.first_disk()];
        m = intersect_disk(Vec3(d.center), Vec3(d.normal), Float(d.radius), ray.o, ray.d, far, t);
    }
    t = t * (Float(1) / scale);
    take(m & (t <= hit.t), t, Float(0), Float(0));
}

/// Closest hits of all rays, by testing every primitive with the intersection functions of src/geometry/shapes.
inline Hits cast_brute_force(const GeometryTables& tables, Rays& rays)
{
    const RayArrays arrays = rays.arrays();
    Hits hits(arrays.count + 32);
    for (std::size_t i = 0; i < arrays.count; i += lanes) {
        const Ray ray{load_vec3(arrays.ox + i, arrays.oy + i, arrays.oz + i),
                      load_vec3(arrays.dx + i, arrays.dy + i, arrays.dz + i), load(arrays.t_max + i),
                      load(arrays.time + i)};
        Hit hit{ray.t_max, UInt(no_index), UInt(no_index), Float(0), Float(0)};
        for (std::uint32_t k = 0; k < tables.primitive_count(); ++k) {
            const bool placed = tables.shapes[tables.shape_of_primitive[k]].flags & ShapeRecord::only_instanced;
            if (!placed) intersect_brute_force(tables, k, ray, Float(1), UInt(no_index), hit);
        }
        for (std::uint32_t k = 0; k < tables.instances.size(); ++k) {
            const InstanceRecord& instance = tables.instances[k];
            const Affine to_object = object_from_render(tables, instance, ray.time);
            const Ray inner{to_object.point(ray.o), to_object.vector(ray.d), ray.t_max, ray.time};
            // Curves and quadrics expect unit directions.
            const Float scale = length(inner.d);
            const Ray unit{inner.o, inner.d * (Float(1) / scale), ray.t_max, ray.time};
            for (std::uint32_t p = tables.shapes[instance.mesh_shape].first_primitive;
                 p < tables.primitive_count() && tables.shape_of_primitive[p] == instance.mesh_shape; ++p)
                if (p < tables.first_sphere())
                    intersect_brute_force(tables, p, inner, Float(1), UInt(k), hit);
                else
                    intersect_brute_force(tables, p, unit, scale, UInt(k), hit);
        }
        store(&hits.t[i], hit.t), store(&hits.u[i], hit.u), store(&hits.v[i], hit.v);
        store(&hits.primitive[i], hit.primitive), store(&hits.instance[i], hit.instance);
    }
    return hits;
}

}  // namespace fathom
