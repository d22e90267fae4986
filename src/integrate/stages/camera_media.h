// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/camera_record.h"
#include "materials/read/material.h"
#include "media/stack.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Nearest hit of one ray, in the first lane.
inline SurfaceHit nearest_hit(const LaneScene& scene, const Vec3& o, const Vec3& d, Float time)
{
    SurfaceHit hit{o, d, Float(infinity), Float(0), Float(0), time, UInt(no_index), UInt(no_index)};
    if (scene.is_flat) {
        const Hit found = scene.flat.closest(scene.tables, Ray{o, d, Float(infinity), time});
        hit.t = found.t, hit.u = found.u, hit.v = found.v, hit.primitive = found.primitive;
        return hit;
    }
    constexpr std::size_t padded = 64;
    float ray[7][padded] = {}, t[padded], u[padded], v[padded];
    std::uint32_t primitive[padded], instance[padded];
    const Float fields[] = {o.x, o.y, o.z, d.x, d.y, d.z, time};
    for (int i = 0; i < 7; ++i) store(ray[i], fields[i]);
    scene.bvh.closest(
        {ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], nullptr, scene.has(Feature::motion) ? ray[6] : nullptr, 1},
        {t, u, v, primitive, instance}, false);
    hit.t = Float(t[0]), hit.u = Float(u[0]), hit.v = Float(v[0]);
    hit.primitive = UInt(primitive[0]), hit.instance = UInt(instance[0]);
    return hit;
}

}  // namespace detail

/// Media that contain a point at a time: those of the solids that a ray from there leaves without having entered them.
[[gnu::noinline]] inline MediumStack media_at(const LaneScene& scene, const float* point, float time)
{
    const SurfaceReader surfaces(scene);
    const MaterialReader materials(scene);
    const auto vector = [](const float* v) { return Vec3(Float(v[0]), Float(v[1]), Float(v[2])); };
    const Mask one = first_lanes(1);
    // The direction is arbitrary; it avoids the axes, along which edges often lie.
    const Vec3 d = normalize(Vec3(Float(0.31f), Float(0.87f), Float(0.42f)));
    Vec3 o = vector(point);
    MediumStack entered;
    constexpr int max_hits = 256, max_left = 4;
    UInt left[max_left];
    int count = 0;
    for (int i = 0; i < max_hits && count < max_left; ++i) {
        const SurfaceHit hit = detail::nearest_hit(scene, o, d, Float(time));
        if (none(one & (hit.primitive != UInt(no_index)))) break;
        const Surface s = surfaces.read(hit, one);
        const UInt medium = materials.get(&MaterialRecord::medium, s.material, one);
        o = fma(flip_sign(s.ng, dot(d, s.ng)), s.offset, s.p);
        if (none(one & (medium != UInt(0u)))) continue;
        if (any(one & (dot(d, s.ng) < Float(0)))) {
            entered = entered.entered(scene.tables, medium, one);
            continue;
        }
        const MediumStack before = entered;
        entered = entered.left(medium);
        if (any(one & (before.low() == entered.low()) & (before.high() == entered.high()))) left[count++] = medium;
    }
    // The outermost solid was left last, so it is entered first.
    MediumStack media;
    while (count > 0) media = media.entered(scene.tables, left[--count], one);
    std::uint32_t low[lanes], high[lanes];
    store(low, media.low()), store(high, media.high());
    return {UInt(low[0]), UInt(high[0])};
}

}  // namespace FATHOM_LANES
}  // namespace fathom
