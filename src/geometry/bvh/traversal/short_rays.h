// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Packet traversal for short occlusion rays that start near each other in any direction, such as shadow rays.
///
/// From the root down, boxes are tested against the bounding box of all rays, then against vectors of rays. Leaves that
/// many rays reach are tested the same way; everything else is deferred to the stacks of single rays.
#include "geometry/bvh/traversal/packet.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Traverses a packet of short occlusion rays through a static scene.
class ShortRayPacketTraversal {
public:
    using RayStream = Stream<true, false>;
    ShortRayPacketTraversal(const BvhData& bvh, StreamMemory& memory, RayStream& stream, RayMask rays)
        : bvh_(bvh), memory_(memory), stream_(stream), rays_(rays)
    {
        for (int axis = 0; axis < 3; ++axis) {
            Float low(infinity), high(infinity);  // lower bounds, and negated upper bounds
            for (int i = 0; i < parts; ++i) {
                const PreparedRays& r = memory.world[i];
                const Mask m = part_of(rays, i);
                const Vec3 o =
                    load_vec3(r.f[PreparedRays::origin_x], r.f[PreparedRays::origin_y], r.f[PreparedRays::origin_z]);
                const Float x = load(r.f[PreparedRays::origin_x + axis]), slack = ray_slack(o, bvh.radius);
                const Float end = fma(load(r.f[PreparedRays::direction_x + axis]),
                                      min(load(r.f[PreparedRays::t_max]), Float(1e30f)), x);  // avoids 0 times infinity
                low = min(low, select(m, min(x, end) - slack, low));
                high = min(high, select(m, -(max(x, end) + slack), high));
                const Float near = load(r.f[PreparedRays::near_x + axis]), far = load(r.f[PreparedRays::far_x + axis]);
                const Mask down = load(r.f[PreparedRays::inverse_x + axis]) < Float(0);
                store(to_low_[axis] + i * lanes, select(down, far, near));
                store(to_high_[axis] + i * lanes, select(down, near, far));
            }
            low_[axis] = least(low);
            high_[axis] = -least(high);
        }
    }

    /// Whether the packet pays: the bounding box of the rays is small relative to the tree.
    bool fits() const
    {
        float size = 0;
        for (int axis = 0; axis < 3; ++axis) size = std::max(size, high_[axis] - low_[axis]);
        return size < 0.25f * bvh_.radius;
    }

    /// Traverses the nodes that are worth visiting as a packet, and starts the remaining subtrees in the stream.
    void run()
    {
        PacketEntry* const stack = memory_.packet_stack.data();
        int size = 0;
        stack[size++] = {rays_, bvh_.root, 0};
        while (size > 0) {
            PacketEntry entry = stack[--size];
            entry.rays &= ~blocked_;
            if (BvhReference::is_node(entry.reference) && std::popcount(entry.rays) > few) {
                size = visit_node(entry, size);
            } else if (BvhReference::is_triangle_leaf(entry.reference) && !bvh_.has_alpha && is_crowded(entry)) {
                intersect_leaf(entry);
            } else {
                defer(entry);
            }
        }
        for (RayMask m = stream_.waiting() & ~blocked_; m; m &= m - 1) stream_.start(std::countr_zero(m));
    }

private:
    static constexpr int parts = stream_size / lanes;
    static constexpr int few = 3;

    /// Whether vectors of rays against each triangle are faster than each ray against all triangles at once. Measured.
    bool is_crowded(const PacketEntry& leaf) const
    {
        return 2 * std::popcount(leaf.rays) > bvh_.triangle_count(leaf.reference) * parts_with(leaf.rays);
    }

    /// Excludes triangles outside the bounding box of the rays (lanes are triangles), then tests the others (lanes are
    /// rays).
    void intersect_leaf(const PacketEntry& entry)
    {
        if (BvhReference::is_indexed_triangles(entry.reference)) return intersect_indexed_leaf(entry);
        const std::ptrdiff_t n = BvhReference::triangle_count(entry.reference);
        const float* const data = &bvh_.triangles[9 * std::size_t(BvhReference::first_triangle(entry.reference))];
        Float low[3], high[3];
        triangle_boxes(data, n, low, high);
        intersect_triangle_leaf(entry, int(n), low, high, n,
                                [&](int i, std::ptrdiff_t vertex) { return data + i + 3 * vertex * n; });
    }
    /// intersect_leaf() for an indexed leaf.
    [[gnu::noinline]] void intersect_indexed_leaf(const PacketEntry& entry)
    {
        const IndexedLeaf leaf = bvh_.indexed_leaf(entry.reference);
        Float low[3], high[3];
        PacketTimes().bounds<false>(leaf, low, high);
        intersect_triangle_leaf(entry, leaf.count(), low, high, leaf.vertices(),
                                [&](int i, int vertex) { return leaf.axis(0) + leaf.corners(vertex)[i]; });
    }
    /// Intersects the rays with n triangles in these boxes. corner(i, vertex) points to x of a vertex; y and z follow
    /// at distance `step`.
    template <class Corner>
    [[gnu::always_inline]] void intersect_triangle_leaf(const PacketEntry& entry, int n, const Float low[3],
                                                        const Float high[3], std::ptrdiff_t step, const Corner& corner)
    {
        memory_.visits.primitives += std::uint64_t(n * std::popcount(entry.rays));
        Mask near = first_lanes(std::size_t(n));
        for (int axis = 0; axis < 3; ++axis)
            near &= (low[axis] <= Float(high_[axis])) & (Float(low_[axis]) <= high[axis]);
        const std::uint32_t triangles = mask_bits(near);
        // Layout of corners: x, y, z and a gap for each corner of each triangle; padded because lookup() may read 32
        // floats.
        alignas(64) float corners[lanes * 12 + 32];
        for (std::uint32_t left = triangles; left; left &= left - 1) {
            const int i = std::countr_zero(left);
            for (int vertex = 0; vertex < 3; ++vertex)
                for (int axis = 0; axis < 3; ++axis)
                    corners[12 * i + 4 * vertex + axis] = corner(i, vertex)[axis * step];
        }
        for (int k = 0; k < parts; ++k)
            if (holds_any(entry.rays, k)) intersect_triangle_leaf(corners, triangles, k, part_of(entry.rays, k));
    }
    /// Intersects one part of the rays with some triangles; blocked rays are not tested further.
    void intersect_triangle_leaf(const float* corners, std::uint32_t triangles, int k, Mask active)
    {
        const TriangleRay ray = memory_.world[k].triangle_ray();
        const Vec3 o = ray.permute(ray.o);
        const UInt x = ray.permuted(0), y = ray.permuted(1), z = ray.permuted(2);
        const Float t_max = load(memory_.hits.t + k * lanes);
        Mask stopped(false);
        for (std::uint32_t left = triangles; left && any(active); left &= left - 1) {
            const float* const triangle = corners + 12 * std::countr_zero(left);
            const auto corner = [&](const float* p) {
                return Vec3{lookup(p, 3, x), lookup(p, 3, y), lookup(p, 3, z)} - o;
            };
            const Vec3 a = corner(triangle), b = corner(triangle + 4), c = corner(triangle + 8);
            TriangleWeights w = triangle_weights(ray.shear_x, ray.shear_y, a, b, c);
            w.inside &= active;
            const Mask hit = w.inside & UndividedHits(w, ray.shear_z, {a.z, b.z, c.z}).before(t_max);
            stopped |= hit;
            active &= !hit;
        }
        std::uint32_t* const what = memory_.hits.what + k * lanes;
        store(what, select(stopped, UInt(0u), load(what)));
        blocked_ |= RayMask(mask_bits(stopped)) << k * lanes;
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
                    const Float inverse = load(r.f[PreparedRays::inverse_x + axis]);
                    const Float low = fma(Float(node.bounds[axis][slot]), inverse, load(to_low_[axis] + k * lanes));
                    const Float high =
                        fma(Float(node.bounds[3 + axis][slot]), inverse, load(to_high_[axis] + k * lanes));
                    near = max(near, min(low, high));
                    far = min(far, max(low, high));
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
    RayStream& stream_;
    RayMask rays_, blocked_ = 0;
    alignas(64) float to_low_[3][stream_size], to_high_[3][stream_size];  ///< near and far offsets of PreparedRays,
                                                                          ///< sorted by side
    float low_[3], high_[3];                                              ///< bounding box of all rays
};

}  // namespace FATHOM_LANES
}  // namespace fathom
