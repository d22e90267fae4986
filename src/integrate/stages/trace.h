// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/lane_scene.h"
#include "kernel/pool.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Finds the nearest hits of the paths [begin, end) of a pool. coherent: a hint that adjacent rays are worth tracing
/// together.
inline void trace_paths(const LaneScene& scene, const PathPool& p, HitColumns& hits, std::size_t begin, std::size_t end,
                        bool coherent)
{
    if (begin == end) return;
    const bool has_time = scene.has(Feature::motion);
    if (scene.is_flat) {
        for (std::size_t i = begin; i < end; i += lanes) {
            const Ray ray{p.origin.load(i), p.direction.load(i), Float(infinity), has_time ? p.time.load(i) : Float(0)};
            const Hit hit = scene.flat.closest(scene.tables, ray);
            hits.t.store(i, hit.t);
            hits.primitive.store(i, hit.primitive);
            hits.u.store(i, hit.u);
            hits.v.store(i, hit.v);
        }
        return;
    }
    const RayArrays rays{&p.origin.x.data[begin],
                         &p.origin.y.data[begin],
                         &p.origin.z.data[begin],
                         &p.direction.x.data[begin],
                         &p.direction.y.data[begin],
                         &p.direction.z.data[begin],
                         nullptr,
                         has_time ? &p.time.data[begin] : nullptr,
                         end - begin};
    scene.bvh.closest(rays,
                      {&hits.t[begin], &hits.u[begin], &hits.v[begin], &hits.primitive[begin], &hits.instance[begin]},
                      coherent);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
