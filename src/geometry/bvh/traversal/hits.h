#pragma once
/// What a thread keeps while it traces a stream of rays, and the nearest hits so far.
#include <vector>

#include "geometry/bvh/traversal/ray.h"

namespace fathom {
inline namespace FATHOM_LANES {

inline constexpr int stream_size = 64;

/// A bit for each ray of a stream.
using RayMask = std::uint64_t;
static_assert(stream_size <= 64);

/// Of each ray the nearest hit so far: the least of (t, key, instance). What was hit is a key or, with this bit, the
/// place of one in BvhData::keys, which is looked up when it is needed: mostly once a ray, at its end.
inline constexpr std::uint32_t hit_is_index = 1u << 31;

struct RayHits {
    /// Past the rays': for what is to be forgotten.
    static constexpr int nowhere = stream_size;

    alignas(64) float t[nowhere + 1], u[nowhere + 1], v[nowhere + 1];
    alignas(64) std::uint32_t what[nowhere + 1], instance[nowhere + 1];

    BvhKey key(const BvhData& bvh, int i) const
    {
        return what[i] != no_index && what[i] & hit_is_index ? bvh.keys[what[i] & ~hit_is_index] : what[i];
    }
    bool loses_to(const BvhData& bvh, int i, float other_t, float other_u, BvhKey other,
                  std::uint32_t other_instance) const
    {
        if (other_t != t[i]) return other_t < t[i];
        const BvhKey own = key(bvh, i);
        if (own == no_index || other != own) return own != no_index && other < own;
        // Of a curve's segment several pieces may be tested.
        return other_instance != instance[i] ? other_instance < instance[i] : other_u < u[i];
    }
    /// Rays that have hit something.
    RayMask found() const
    {
        RayMask rays = 0;
        for (int i = 0; i < stream_size; i += lanes) rays |= RayMask(mask_bits(load(what + i) != UInt(no_index))) << i;
        return rays;
    }
    void set(int i, float new_t, float new_u, float new_v, std::uint32_t new_what, std::uint32_t new_instance)
    {
        t[i] = new_t, u[i] = new_u, v[i] = new_v, what[i] = new_what, instance[i] = new_instance;
    }
};

struct PacketEntry {
    std::uint64_t rays;
    std::uint32_t reference;
    float t;
};
/// What rays through a moving scene need besides.
struct RayTimes {
    alignas(64) float shutter[stream_size];   ///< 0 when it opens, 1 when it closes
    alignas(64) float fraction[stream_size];  ///< of the way between vertex_times
    alignas(64) std::uint32_t key[stream_size];
};
/// What a thread needs to trace streams; kept between calls.
struct StreamMemory {
    RayTimes times;
    PreparedRays world[stream_size / lanes], object[stream_size / lanes];
    PreparedRays together[stream_size / lanes];  ///< of a packet within an instance
    RayHits hits;
    BvhVisits visits;
    std::vector<std::uint32_t> stacks;
    std::vector<PacketEntry> packet_stack;
};

/// Whether a hit of a ray of the stream counts. u, v: as RayHits has them.
inline bool passes_alpha(const BvhData& bvh, const StreamMemory& memory, int ray, BvhKey key, std::uint32_t instance,
                         float t, float u, float v)
{
    const GeometryTables& tables = *bvh.tables;
    const std::uint32_t shape =
        instance == no_index ? tables.shape_of_primitive[key >> 1] : tables.instances[instance].shape;
    if (!(tables.shapes[shape].flags & ShapeRecord::alpha_tested)) return true;
    if (key & 1) u = 1 - u, v = 1 - v;
    const PreparedRays& world = memory.world[ray / lanes];
    const auto number = [&](int field) { return world.f[field][ray % lanes]; };
    const AlphaCandidate candidate{
        {number(PreparedRays::origin_x), number(PreparedRays::origin_y), number(PreparedRays::origin_z)},
        {number(PreparedRays::direction_x), number(PreparedRays::direction_y), number(PreparedRays::direction_z)},
        t,
        u,
        v,
        key >> 1,
        instance};
    return bvh.alpha_test(bvh.alpha_context, candidate);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
