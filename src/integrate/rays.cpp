/// Rays from outside of the path loop, for benchmarks.
#include "integrate/surface.h"

namespace fathom::inline FATHOM_LANES {

const BvhStatistics& LaneScene::need_tree()
{
    if (is_flat && bvh.statistics().bytes == 0) bvh.build(tables);
    return bvh.statistics();
}

void LaneScene::closest(const RayArrays& rays, const HitArraysOut& hits, bool coherent, BvhVisits& visits) const
{
    bvh.closest(rays, hits, coherent, &visits);
}

void LaneScene::occluded(const RayArrays& rays, std::uint32_t* blocked, bool coherent, BvhVisits& visits) const
{
    bvh.occluded(rays, blocked, coherent, &visits);
}

void LaneScene::surface(const RayArrays& rays, const HitArraysOut& hits, float* const points[3],
                        float* const normals[3]) const
{
    const SurfaceReader reader(*this);
    for (std::size_t i = 0; i < rays.count; i += lanes) {
        SurfaceHit hit;
        hit.o = load_vec3(rays.ox + i, rays.oy + i, rays.oz + i);
        hit.d = load_vec3(rays.dx + i, rays.dy + i, rays.dz + i);
        hit.t = load(hits.t + i);
        hit.u = load(hits.u + i);
        hit.v = load(hits.v + i);
        hit.time = rays.time ? load(rays.time + i) : Float(tables.shutter_open);
        hit.primitive = load(hits.primitive + i);
        hit.instance = load(hits.instance + i);
        const Surface s = reader.read(hit, first_lanes(rays.count - i) & (hit.primitive != UInt(no_index)));
        const Vec3 n = flip_sign(s.ng, -dot(s.ng, hit.d));
        const Float p[] = {s.p.x, s.p.y, s.p.z}, towards[] = {n.x, n.y, n.z};
        for (int axis = 0; axis < 3; ++axis) store(points[axis] + i, p[axis]), store(normals[axis] + i, towards[axis]);
    }
}

}  // namespace fathom::inline FATHOM_LANES
