#pragma once
/// Rays and scenes for the tests of ray casting, and the plainest way to cast them: every primitive in turn.
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/bvh.h"
#include "geometry/bvh_ray.h"

namespace fathom {

/// PCG (O'Neill 2014), 32 bits of output.
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

/// Tables with one shape for all that is in the world.
inline SceneTables empty_tables()
{
    SceneTables tables;
    tables.shapes.emplace_back();
    tables.materials.emplace_back();
    return tables;
}
inline void add_triangle(SceneTables& tables, Vec3f a, Vec3f b, Vec3f c)
{
    for (Vec3f v : {a, b, c}) {
        tables.triangles.push_back(std::uint32_t(tables.positions.size()));
        tables.positions.push_back(v);
    }
}
/// To be called when all primitives are there; instanced meshes have been numbered already.
inline void finish(SceneTables& tables)
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
    std::size_t count() const { return count_ ? count_ : t_max.size(); }
    RayArrays arrays()
    {
        count_ = count();
        for (auto* a : {&o[0], &o[1], &o[2], &d[0], &d[1], &d[2], &t_max, &time})
            a->resize(count_ + 32, a->empty() ? 1 : a->back());
        return {o[0].data(), o[1].data(),  o[2].data(), d[0].data(), d[1].data(),
                d[2].data(), t_max.data(), time.data(), count_};
    }

private:
    std::size_t count_ = 0;
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
inline std::vector<std::uint32_t> cast_shadows(const Bvh& bvh, Rays& rays, bool coherent)
{
    const RayArrays arrays = rays.arrays();
    std::vector<std::uint32_t> blocked(arrays.count);
    bvh.occluded(arrays, blocked.data(), coherent);
    return blocked;
}

/// The nearest hits by testing everything, with the tests of geometry/shapes.h.
inline Hits cast_by_force(const SceneTables& tables, Rays& rays)
{
    const RayArrays arrays = rays.arrays();
    Hits hits(arrays.count + 32);
    const auto meet_triangles = [&](const Ray& ray, std::uint32_t first, std::uint32_t last, UInt instance, Hit& hit) {
        const TriangleRay shear(ray);
        for (std::uint32_t key = 2 * first; key < 2 * last; ++key) {
            if (key & 1 && key / 2 < tables.first_quad()) continue;
            Vec3f v[3];
            vertices_of(tables, key, v);
            Float t, b1, b2;
            const auto corner = [&](int k) { return shear.permute(Vec3(v[k]) - ray.o); };
            const Vec3 pa = corner(0), pb = corner(1), pc = corner(2);
            const TriangleWeights w = triangle_weights(shear.shear_x, shear.shear_y, pa, pb, pc);
            if (none(w.inside)) continue;
            Mask m = triangle_distance(w, shear.shear_z, {pa.z, pb.z, pc.z}, hit.t, t, b1, b2);
            const Mask first_instance = (hit.primitive == UInt(key / 2)) & less(instance, hit.instance);
            m &= (t < hit.t) | less(UInt(key / 2), hit.primitive) | first_instance;
            hit.t = select(m, t, hit.t);
            hit.u = select(m, key & 1 ? Float(1) - b1 : b1, hit.u);
            hit.v = select(m, key & 1 ? Float(1) - b2 : b2, hit.v);
            hit.primitive = select(m, UInt(key / 2), hit.primitive);
            hit.instance = select(m, instance, hit.instance);
        }
    };
    for (std::size_t i = 0; i < arrays.count; i += lanes) {
        const Ray ray{load_vec3(arrays.ox + i, arrays.oy + i, arrays.oz + i),
                      load_vec3(arrays.dx + i, arrays.dy + i, arrays.dz + i), load(arrays.t_max + i),
                      load(arrays.time + i)};
        Hit hit{ray.t_max, UInt(no_index), UInt(no_index), Float(0), Float(0)};
        meet_triangles(ray, 0, tables.world_triangles, UInt(no_index), hit);
        meet_triangles(ray, tables.first_quad(), tables.first_sphere(), UInt(no_index), hit);
        for (std::uint32_t k = 0; k < tables.spheres.size(); ++k)
            closest_sphere(tables.spheres[k], tables.first_sphere() + k, ray, hit);
        for (std::uint32_t k = 0; k < tables.disks.size(); ++k)
            closest_disk(tables.disks[k], tables.first_disk() + k, ray, hit);
        for (std::uint32_t k = 0; k < tables.instances.size(); ++k) {
            const InstanceTable& instance = tables.instances[k];
            const std::uint32_t first = tables.shapes[instance.mesh_shape].first_primitive;
            std::uint32_t last = first;
            while (last < tables.triangle_count() && tables.shape_of_primitive[last] == instance.mesh_shape) ++last;
            const Ray inner{transform_point(instance.object_from_render, ray.o),
                            transform_vector(instance.object_from_render, ray.d), ray.t_max, ray.time};
            meet_triangles(inner, first, last, UInt(k), hit);
        }
        store(&hits.t[i], hit.t), store(&hits.u[i], hit.u), store(&hits.v[i], hit.v);
        store(&hits.primitive[i], hit.primitive), store(&hits.instance[i], hit.instance);
    }
    return hits;
}

}  // namespace fathom
