#pragma once
/// Short rays that start near each other, in any direction: they share the upper part of their way.
///
/// From the root down, boxes are tested against the box that holds all the rays, then against the rays, by vectors.
/// Leaves, and nodes that are cheaper for each ray alone, are put on the rays' own stacks; a leaf that many come to is
/// met at once, as long as such leaves stop rays.
#include "geometry/bvh_packet.h"

namespace fathom::inline FATHOM_LANES {

template <bool any_hit, bool moving>
class NeighbourTraversal {
public:
    NeighbourTraversal(const BvhData& bvh, StreamMemory& memory, Stream<any_hit, moving>& stream, RayMask rays)
        : bvh_(bvh), memory_(memory), stream_(stream), rays_(rays)
    {
        for (int axis = 0; axis < 3; ++axis) {
            Float low(infinity), high(infinity);  // high: negated
            for (int i = 0; i < parts; ++i) {
                const PreparedRays& r = memory.world[i];
                const Mask m = part_of(rays, i);
                const Vec3 o =
                    load_vec3(r.f[PreparedRays::origin_x], r.f[PreparedRays::origin_y], r.f[PreparedRays::origin_z]);
                const Float x = load(r.f[PreparedRays::origin_x + axis]), slack = ray_slack(o, bvh.radius);
                const Float end = fma(load(r.f[PreparedRays::direction_x + axis]),
                                      min(load(r.f[PreparedRays::t_max]), Float(1e30f)), x);  // not 0 times infinity
                low = min(low, select(m, min(x, end) - slack, low));
                high = min(high, select(m, -(max(x, end) + slack), high));
            }
            low_[axis] = least(low);
            high_[axis] = -least(high);
        }
    }

    /// Whether it is worth while: the rays' box is small beside the tree.
    bool fits() const
    {
        float size = 0;
        for (int axis = 0; axis < 3; ++axis) size = std::max(size, high_[axis] - low_[axis]);
        return size < 0.25f * bvh_.radius;
    }

    void run()
    {
        PacketEntry* const stack = memory_.packet_stack.data();
        int size = 0;
        stack[size++] = {rays_, bvh_.root, 0};
        while (size > 0) {
            PacketEntry entry = stack[--size];
            entry.rays &= ~blocked_;
            if (BvhReference::is_node(entry.reference) && !BvhReference::is_moving(entry.reference) &&
                std::popcount(entry.rays) > few) {
                size = visit_node(entry, size);
            } else {
                defer(entry);
                if (BvhReference::is_triangle_leaf(entry.reference) && std::popcount(entry.rays) > crowd_)
                    finish(entry.rays);
            }
        }
        for (RayMask m = stream_.waiting() & ~blocked_; m; m &= m - 1) stream_.start(std::countr_zero(m));
    }

private:
    static constexpr int parts = stream_size / lanes;
    static constexpr int few = 3;

    /// Where many rays come to a leaf, those that it stops need not go on.
    void finish(RayMask rays)
    {
        for (RayMask m = rays; m; m &= m - 1) stream_.start(std::countr_zero(m));
        stream_.run();
        stream_.forget(rays);
        const RayMask stopped = rays & memory_.hits.found();
        blocked_ |= stopped;
        if (4 * std::popcount(stopped) < std::popcount(rays)) crowd_ *= 2;
    }
    void defer(const PacketEntry& entry)
    {
        for (RayMask m = entry.rays; m; m &= m - 1) defer(std::countr_zero(m), entry.reference);
    }
    void defer(int ray, std::uint32_t reference)
    {
        if (!stream_.defer(ray, reference, 0)) make_room(ray, reference);
    }
    [[gnu::noinline]] void make_room(int ray, std::uint32_t reference)
    {
        stream_.start(ray);
        stream_.run();
        stream_.forget(RayMask(1) << ray);
        stream_.defer(ray, reference, 0);
    }

    /// Whether vectors of rays against so many boxes take less time than each ray alone against all boxes of the node.
    static bool are_many(RayMask rays, int boxes)
    {
        constexpr int tests_alone = 4;  // that take as long as a ray alone; measured
        int parts_in_use = 0;
        for (int k = 0; k < parts; ++k) parts_in_use += holds_any(rays, k);
        return tests_alone * std::popcount(rays) >= boxes * parts_in_use;
    }

    int visit_node(const PacketEntry& entry, int size)
    {
        const BvhNode& node = bvh_.nodes[entry.reference];
        const RayMask rays = entry.rays;
        std::uint32_t met = 0;
        for (int k = 0; k < box_parts; ++k) {
            Mask m(true);
            for (int axis = 0; axis < 3; ++axis)
                m &= (load(node.bounds[axis] + k * lanes) <= Float(high_[axis])) &
                     (Float(low_[axis]) <= load(node.bounds[3 + axis] + k * lanes));
            met |= mask_bits(m) << k * lanes;
        }
        if (!are_many(rays, std::popcount(met))) {
            defer(entry);
            return size;
        }
        memory_.visits.nodes += std::uint64_t(std::popcount(rays));
        for (; met; met &= met - 1) {
            const int slot = std::countr_zero(met);
            RayMask meet = 0;
            for (int k = 0; k < parts; ++k) {
                if (!holds_any(rays, k)) continue;
                const PreparedRays& r = memory_.world[k];
                Float near(0.f), far = load(memory_.hits.t + k * lanes);
                for (int axis = 0; axis < 3; ++axis) {
                    const Float low(node.bounds[axis][slot]), high(node.bounds[3 + axis][slot]);
                    const Float inverse = load(r.f[PreparedRays::inverse_x + axis]);
                    const Mask down = inverse < Float(0);
                    near = max(near, fma(select(down, high, low), inverse, load(r.f[PreparedRays::near_x + axis])));
                    far = min(far, fma(select(down, low, high), inverse, load(r.f[PreparedRays::far_x + axis])));
                }
                meet |= RayMask(mask_bits(near <= far)) << k * lanes;
            }
            meet &= rays;
            memory_.packet_stack[std::size_t(size)] = {meet, node.child[slot], 0};
            size += meet != 0;
        }
        return size;
    }

    const BvhData& bvh_;
    StreamMemory& memory_;
    Stream<any_hit, moving>& stream_;
    RayMask rays_, blocked_ = 0;
    int crowd_ = 8;           ///< so many rays at a leaf meet it at once
    float low_[3], high_[3];  ///< of the box around all rays
};

}  // namespace fathom::inline FATHOM_LANES
