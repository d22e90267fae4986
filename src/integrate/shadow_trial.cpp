// SPDX-License-Identifier: Apache-2.0
#include "integrate/shadow_trial.h"

#include "kernel/camera_paths.h"
#include "lights/sample/light_stage.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace {

/// More rays do not help: few of them reach the deep nodes, whose order hardly matters.
constexpr std::size_t max_rays = 2048;

/// Rays and their hits in columns, padded for whole registers.
struct Rays {
    std::vector<float> column[10];  ///< columns: origin, direction, t_max, and t, u, v of hits
    std::vector<std::uint32_t> primitive, instance;
    std::size_t count = 0;

    Rays()
    {
        for (std::vector<float>& c : column) c.resize(max_rays + 64);
        primitive.resize(max_rays + 64), instance.resize(max_rays + 64);
    }
    float* at(int k, std::size_t i) { return &column[k][i]; }
    Vec3 origin(std::size_t i) { return load_vec3(at(0, i), at(1, i), at(2, i)); }
    Vec3 direction(std::size_t i) { return load_vec3(at(3, i), at(4, i), at(5, i)); }
    Float hit_distance(std::size_t i) { return load(at(7, i)); }
    void append(const Vec3& o, const Vec3& d, Float t_max, Mask m)
    {
        const Float values[] = {o.x, o.y, o.z, d.x, d.y, d.z, t_max};
        for (int k = 0; k < 7; ++k) compress_store(at(k, count), values[k], m);
        count += std::size_t(fathom::count(m));
    }
    RayArrays arrays(bool limited)
    {
        return {at(0, 0), at(1, 0), at(2, 0), at(3, 0), at(4, 0), at(5, 0), limited ? at(6, 0) : nullptr,
                nullptr,  count};
    }
    void trace(const Bvh& bvh)
    {
        bvh.closest(arrays(false), {at(7, 0), at(8, 0), at(9, 0), primitive.data(), instance.data()}, false);
    }
};

/// Random numbers of ray i (and the next lanes - 1) of a round.
struct Numbers {
    SampleKey key;
    UInt seed;
    Numbers(std::size_t i, std::uint32_t round)
        : key{UInt(0x2545f491u), reverse_bits(iota() + UInt(std::uint32_t(i)))}, seed(group_seed(key, UInt(round)))
    {
    }
    Sample2 pair(std::uint32_t which) const { return sample_2d(key, pair_seed(seed, which)); }
};

Vec3 any_direction(Sample2 u)
{
    return sample_cone(u, Float(2));
}

/// Rays from random points of triangles in random directions. All triangles are equally likely, since dense regions
/// tend to be the visible ones.
Rays from_triangles(const GeometryTables& tables)
{
    Rays rays;
    const UInt last(tables.world_triangles - 1);
    for (std::size_t i = 0; i < max_rays; i += lanes) {
        const Numbers numbers(i, 0);
        const UInt any = to_uint(numbers.pair(0).x * Float(float(tables.world_triangles)));
        // Rounding may turn the product into the number of triangles, which is not a valid index.
        const UInt number = select(less(any, last), any, last);
        Vec3 corner[3];
        for (std::uint32_t k = 0; k < 3; ++k) {
            const UInt vertex = gather(tables.triangles.data(), number * UInt(3u) + UInt(k));
            corner[k] = gather(tables.positions, vertex, Mask(true));
        }
        const Sample2 u = numbers.pair(1);
        const Float root = sqrt(u.x);
        const Vec3 p = corner[0] * (Float(1) - root) + corner[1] * (root * (Float(1) - u.y)) + corner[2] * (root * u.y);
        rays.append(p, any_direction(numbers.pair(2)), Float(infinity), Mask(true));
    }
    return rays;
}

/// A point just short of the hit of ray i.
Vec3 place(Rays& rays, std::size_t i)
{
    return fma(rays.direction(i), rays.hit_distance(i) * Float(1 - 0x1p-12f), rays.origin(i));
}
Mask have_met(const Rays& rays, std::size_t i)
{
    return first_lanes(rays.count - i) & (load(&rays.primitive[i]) != UInt(no_index));
}

/// Rays from the hits of other rays, starting on the side from which those rays came.
Rays bounced(Rays& rays)
{
    Rays next;
    for (std::size_t i = 0; i < rays.count; i += lanes) {
        const Vec3 d = any_direction(Numbers(i, 1).pair(0));
        const Vec3 back = select(dot(d, rays.direction(i)) > Float(0), -d, d);
        next.append(place(rays, i), back, Float(infinity), have_met(rays, i));
    }
    return next;
}

/// Shadow rays from hits to sampled lights.
Rays to_lights(const LaneScene& scene, Rays& rays)
{
    const LightSampler lights(scene, LightSelection::tree, true);
    Rays next;
    for (std::size_t i = 0; i < rays.count; i += lanes) {
        const Numbers numbers(i, 2);
        const Vec3 eye = place(rays, i);
        const Mask met = have_met(rays, i);
        if (none(met)) continue;
        const LightSample s = lights.sample(met, eye, numbers.key, numbers.seed, numbers.pair(pair_light), Float(0));
        const Mask useful = met & (s.inverse_pdf > Float(0)) & (dot(s.wi, rays.direction(i)) < Float(0));
        next.append(eye, s.wi, s.distance * Float(1 - 0x1p-12f), useful);
    }
    return next;
}

}  // namespace

void order_by_trial_shadow_rays(LaneScene& scene)
{
    const SceneTables& tables = scene.tables;
    // BVHs of scenes that move or may be edited ignore the result.
    if (scene.is_flat || tables.moving || tables.editable) return;
    if (tables.lights.empty() || tables.world_triangles == 0) return;
    Rays rays = from_triangles(tables);
    rays.trace(scene.bvh);
    // The hits are points where paths may scatter; the triangles where the rays started may lie inside closed objects.
    rays = bounced(rays);
    rays.trace(scene.bvh);
    Rays shadows = to_lights(scene, rays);
    scene.bvh.expect(shadows.arrays(true));
}

}  // namespace FATHOM_LANES
}  // namespace fathom
