// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Per-thread memory for tracing a stream of rays, and the nearest hits so far.
#include <vector>

#include "geometry/bvh/traversal/ray.h"

namespace fathom {
inline namespace FATHOM_LANES {

inline constexpr int stream_size = 64;

/// One bit for each ray of a stream.
using RayMask = std::uint64_t;
static_assert(stream_size <= 64);

/// The nearest hit of each ray so far: the minimum of (t, key, instance). `what` is a key or, with this bit set, an
/// index into BvhData::keys. The lookup is deferred, usually to the end of a ray.
inline constexpr std::uint32_t hit_is_index = 1u << 31;

/// The nearest hits of a stream's rays so far, in columns.
struct RayHits {
    /// Slot past the rays, for values to be discarded.
    static constexpr int discard_slot = stream_size;

    alignas(64) float t[discard_slot + 1], u[discard_slot + 1], v[discard_slot + 1];
    alignas(64) std::uint32_t what[discard_slot + 1], instance[discard_slot + 1];

    /// The key of ray i's hit, or no_index.
    BvhKey key(const BvhData& bvh, int i) const
    {
        return what[i] != no_index && what[i] & hit_is_index ? bvh.keys[what[i] & ~hit_is_index] : what[i];
    }
    /// Whether another hit precedes the hit of ray i.
    bool is_preceded_by(const BvhData& bvh, int i, float other_t, float other_u, BvhKey other,
                        std::uint32_t other_instance) const
    {
        if (other_t != t[i]) return other_t < t[i];
        const BvhKey own = key(bvh, i);
        if (own == no_index || other != own) return own != no_index && other < own;
        // Pieces of one curve segment have equal keys; the smaller u decides between them.
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

/// Entry of a packet's stack: rays, a subtree, and the entry distance of its box.
struct PacketEntry {
    std::uint64_t rays;
    std::uint32_t reference;
    float t;
};
/// Times of rays through a moving scene.
struct RayTimes {
    alignas(64) float shutter[stream_size];   ///< 0 at shutter open, 1 at shutter close
    alignas(64) float fraction[stream_size];  ///< position between vertex_times[key] and the next
    alignas(64) std::uint32_t key[stream_size];
};
/// Memory of a thread for tracing streams, kept between calls.
struct StreamMemory {
    RayTimes times;
    PreparedRays world[stream_size / lanes], object[stream_size / lanes];
    PreparedRays together[stream_size / lanes];  ///< rays of a packet in the object space of an instance
    RayHits hits;
    BvhVisits visits;
    AlphaTest alpha_test = nullptr;  ///< of the rays
    std::vector<std::uint32_t> stacks;
    std::vector<PacketEntry> packet_stack;
};

/// A candidate for the hit of a ray. t, u, v: as in RayHits.
struct HitCandidate {
    BvhKey key;
    std::uint32_t instance;
    float t, u, v;
};

/// Whether a candidate hit of a ray counts: alpha-tested shapes let some rays pass.
inline bool passes_alpha(const BvhData& bvh, const StreamMemory& memory, int ray, const HitCandidate& hit)
{
    auto [key, instance, t, u, v] = hit;
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
    return memory.alpha_test(bvh.alpha_context, candidate);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
