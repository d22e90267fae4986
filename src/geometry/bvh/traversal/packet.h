// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Packet traversal: up to stream_size coherent rays traverse the tree together; lanes are rays.
///
/// All rays must share the signs of their directions and the longest axis. A box or triangle is first tested against
/// intervals over all rays, then against each ray. Where few rays are left, the subtree is deferred to the stacks of
/// those rays, and traversed after the packet is done.
#include "geometry/bvh/traversal/intervals.h"
#include "geometry/bvh/traversal/stream.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// within: whether the rays are in the space of an instance, in memory.together; otherwise they are in world space.
template <bool any_hit, bool moving, bool in_instance = false>
class PacketTraversal {
public:
    /// The tree to traverse, and the space of its rays.
    struct Space {
        std::uint32_t root, instance;
        float radius;
    };

    /// The rays must be coherent (see alike()) and known to the stream. stack_size: number of entries of the packet
    /// stack in use.
    PacketTraversal(const BvhData& bvh, StreamMemory& memory, Stream<any_hit, moving>& stream, RayMask rays,
                    const Space& space, int stack_size = 0)
        : bvh_(bvh), memory_(memory), stream_(stream), rays_(rays), space_(space), bottom_(stack_size)
    {
        const int first = std::countr_zero(rays);
        const PreparedRay r{&part(first / lanes).f[0][first % lanes]};
        for (int k = 0; k < 3; ++k) {
            side_[k] = r.integer(PreparedRays::side_x + k);
            axes_[k] = (r.integer(PreparedRays::axis) + std::uint32_t(k) + 1) % 3;
        }
        octant_ = r.integer(PreparedRays::octant);
        all_ = RayIntervals::find(
            of_part_, [this](int k) -> const PreparedRays& { return part(k); }, rays, octant_, space.radius);
        if (moving) times_ = PacketTimes(memory.times, rays);
        update_reach();
    }

    /// Traverses the nodes that are worth visiting as a packet, and starts the remaining subtrees in the stream.
    void run()
    {
        PacketEntry* const stack = memory_.packet_stack.data();
        int size = bottom_;
        stack[size++] = {rays_, space_.root, 0};
        while (size > bottom_) {
            const PacketEntry entry = stack[--size];
            const RayMask rays = entry.rays & reached_by(entry.t);
            if (rays == 0) continue;
            const bool is_node = BvhReference::is_node(entry.reference);
            if (are_few(rays, is_node)) {
                defer({rays, entry.reference, entry.t});
            } else if (!is_node && !BvhReference::is_triangles(entry.reference)) {
                visit_other(entry.reference, entry.t, rays, size);
            } else if (is_node) {
                size = visit_node({rays, entry.reference, entry.t}, size);
            } else {
                visit_leaf(entry.reference, rays);
            }
        }
        start(rays_);
    }
    RayMask blocked() const { return blocked_; }

private:
    static constexpr int parts = stream_size / lanes;
    static constexpr int few_moving = any_hit ? 12 : 2;
    /// With up to this many rays, a leaf is tested ray by ray with triangles as lanes. Rays at different times through
    /// moving geometry reach leaves less coherently.
    static constexpr int few_at_leaf = moving ? 12 : 0;
    /// Smallest number of rays that enter an instance together.
    static constexpr int min_within = 8;

    /// Whether rays should continue one by one: the cost of a joint visit is per part with any ray. The limits were
    /// measured.
    static bool are_few(RayMask rays, bool is_node)
    {
        if (moving) return std::popcount(rays) <= few_moving;
        if (!any_hit) return std::popcount(rays) <= (is_node ? 6 : 3);
        return std::popcount(rays) <= 1 + (is_node ? 3 : 2) * parts_with(rays);
    }
    const PreparedRays& part(int i) const { return in_instance ? memory_.together[i] : memory_.world[i]; }
    std::uint32_t instance() const { return in_instance ? space_.instance : no_index; }

    /// Rays whose current hit is not nearer than t.
    RayMask reached_by(float t) const
    {
        RayMask rays = 0;
        for (int i = 0; i < parts; ++i)
            rays |= RayMask(mask_bits(Float(t) <= load(memory_.hits.t + i * lanes))) << i * lanes;
        return rays & ~blocked_;
    }

    void update_reach(int k)
    {
        of_part_[k].reach = -least(select(part_of(rays_, k), -load(memory_.hits.t + k * lanes), Float(1)));
    }
    void update_reach()
    {
        all_.reach = -1;
        for (int k = 0; k < parts; ++k) {
            update_reach(k);
            all_.reach = std::max(all_.reach, of_part_[k].reach);
        }
    }

    void defer(const PacketEntry& entry)
    {
        for (RayMask m = entry.rays; m; m &= m - 1) defer(std::countr_zero(m), entry.reference, entry.t);
    }
    void defer(int ray, std::uint32_t reference, float t)
    {
        if (!stream_.defer(ray, reference, t)) make_room(ray, reference, t);
    }
    [[gnu::noinline]] void make_room(int ray, std::uint32_t reference, float t)
    {
        stream_.start(ray);
        stream_.run();
        begin_again(RayMask(1) << ray);
        stream_.defer(ray, reference, t);
    }
    /// Starts the deferred subtrees of these rays.
    void start(RayMask rays)
    {
        for (RayMask m = rays & ~blocked_ & stream_.waiting(); m; m &= m - 1) stream_.start(std::countr_zero(m));
    }
    /// Restores the state of rays that the stream has finished, so that they continue in this packet.
    void begin_again(RayMask rays)
    {
        stream_.forget(rays);
        for (RayMask m = in_instance ? rays : 0; m; m &= m - 1) {
            const int ray = std::countr_zero(m);
            stream_.enter(ray, instance(), &part(ray / lanes).f[0][ray % lanes]);
        }
        if (any_hit) blocked_ |= rays & memory_.hits.found();
    }

    [[gnu::noinline]] void visit_other(std::uint32_t reference, float t, RayMask rays, int size)
    {
        if constexpr (!in_instance)
            if (BvhReference::other_kind(reference) == BvhReference::instance && std::popcount(rays) >= min_within)
                return visit_instance(BvhReference::place(reference), rays, size);
        if (BvhReference::is_indexed_triangles(reference)) return visit_indexed_leaf(reference, rays);
        // Each ray is traced alone now rather than later, since a hit makes farther visits unnecessary.
        defer({rays, reference, t});
        finish(rays);
    }

    /// Lets the stream traverse the deferred subtrees of these rays.
    void finish(RayMask rays)
    {
        start(rays);
        stream_.run();
        begin_again(rays);
        if (!any_hit) update_reach();
    }

    /// Rays that are still coherent in the object space of an instance stay a packet there.
    [[gnu::noinline]] void visit_instance(std::uint32_t index, RayMask rays, int size)
    {
        const InstanceRecord& instance = bvh_.tables->instances[index];
        const BvhData::Mesh& mesh = bvh_.meshes[instance.mesh_shape];
        for (int i = 0; i < parts; ++i) {
            const PreparedRays& r = part(i);
            const auto vector = [&](int f) { return load_vec3(r.f[f], r.f[f + 1], r.f[f + 2]); };
            const Float time = load(r.f[PreparedRays::time]);
            const Affine to_object = object_from_render(*bvh_.tables, instance, time);
            memory_.together[i].prepare(to_object.point(vector(PreparedRays::origin_x)),
                                        to_object.vector(vector(PreparedRays::direction_x)),
                                        load(r.f[PreparedRays::t_max]), time, mesh.radius);
        }
        for (RayMask rest = rays; rest;) {
            const RayMask same = coherent_rays(memory_.together, rest);
            rest &= ~same;
            if (std::popcount(same) < min_within) {
                for (RayMask m = same; m; m &= m - 1)
                    defer(std::countr_zero(m), BvhReference::others(BvhReference::instance, index), 0);
                continue;
            }
            for (RayMask m = same; m; m &= m - 1) {
                const int ray = std::countr_zero(m);
                stream_.enter(ray, index, &memory_.together[ray / lanes].f[0][ray % lanes]);
            }
            PacketTraversal<any_hit, moving, true> inner(bvh_, memory_, stream_, same, {mesh.root, index, mesh.radius},
                                                         size);
            inner.run();
            blocked_ |= inner.blocked() & same;
        }
        // The deferred subtrees of inner packets are traversed here, together with those of single rays.
        finish(rays);
    }

    /// Lists the slots whose box may be hit, the first to visit last, and their distances; returns their number.
    [[gnu::always_inline]] static int slots_hit(const BoxDistances& box, std::uint32_t* slots, float* t)
    {
        alignas(64) float near[bvh_width];
        std::uint32_t bits = 0;
        for (int k = 0; k < box_parts; ++k) {
            store(near + k * lanes, box.near[k]);
            bits |= mask_bits(box.near[k] <= box.far[k]) << k * lanes;
        }
        int count = 0;
        for (; bits; bits &= bits - 1) {
            slots[count] = std::uint32_t(std::countr_zero(bits));
            t[count] = near[slots[count]];
            ++count;
        }
        return count;
    }

    int visit_node(const PacketEntry& entry, int size)
    {
        const auto [rays, reference, t] = entry;
        const BvhNode& node = bvh_.nodes[moving ? BvhReference::node(reference) : reference];
        const float* const bounds = node.bounds[0];
        // `change` is the change of the boxes over the shutter interval, or null if they are static.
        const float* const change = moving && BvhReference::is_moving(reference) ? (&node)[1].bounds[0] : nullptr;
        BoxDistances box;
        for (int k = 0; k < box_parts; ++k) {
            box.near[k] = Float(0);
            box.far[k] = Float(all_.reach);
            for (int axis = 0; axis < 3; ++axis) {
                const std::ptrdiff_t near_row = side_[axis] + k * lanes,
                                     far_row = (2 * axis + 3) * bvh_width - side_[axis] + k * lanes;
                Float near = load(bounds + near_row), far = load(bounds + far_row);
                if (moving && change) {
                    // Each plane takes its most conservative position over the times of all rays.
                    const bool down = octant_ >> axis & 1;
                    const Float near_change = load(change + near_row), far_change = load(change + far_row);
                    const Float near_end = fma(near_change, Float(times_.last_shutter), near),
                                far_end = fma(far_change, Float(times_.last_shutter), far);
                    near = fma(near_change, Float(times_.first_shutter), near);
                    far = fma(far_change, Float(times_.first_shutter), far);
                    near = down ? max(near, near_end) : min(near, near_end);
                    far = down ? min(far, far_end) : max(far, far_end);
                }
                all_.distances(axis, near, far, box.near[k], box.far[k]);
            }
        }
        static constexpr std::array<std::uint32_t, bvh_width> slots = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                       8, 9, 10, 11, 12, 13, 14, 15};
        alignas(64) static constexpr auto aligned_slots = slots;
        alignas(64) std::uint32_t met[2 * bvh_width];
        alignas(64) float met_t[2 * bvh_width];
        const int count = any_hit ? slots_hit(box, met, met_t)
                                  : push_in_order({met, met_t}, 0, aligned_slots.data(), node.order[octant_], box);
        if (any_hit && !moving && !are_many(rays, count)) {
            defer(entry);
            return size;
        }
        memory_.visits.nodes += std::uint64_t(std::popcount(rays));
        for (int i = 0; i < count; ++i) {
            const std::uint32_t slot = met[i];
            if (moving && change) {
                const RayMask meet = intersect_moving(bounds + slot, change + slot, rays);
                memory_.packet_stack[std::size_t(size)] = {meet, node.child[slot], met_t[i]};
                size += meet != 0;
                continue;
            }
            const auto plane = [&](std::ptrdiff_t side) { return Float(bounds[std::ptrdiff_t(slot) + side]); };
            constexpr std::ptrdiff_t row = bvh_width;
            const Vec3 near_planes{plane(side_[0]), plane(side_[1]), plane(side_[2])};
            const Vec3 far_planes{plane(3 * row - side_[0]), plane(5 * row - side_[1]), plane(7 * row - side_[2])};
            RayMask meet = 0;
            for (int k = 0; k < parts; ++k) {
                if (!holds_any(rays, k)) continue;
                const PreparedRays& r = part(k);
                const auto field = [&](int f) { return load(r.f[f]); };
                const Float ix = field(PreparedRays::inverse_x), iy = field(PreparedRays::inverse_y),
                            iz = field(PreparedRays::inverse_z);
                const Float near = max(max(fma(near_planes.x, ix, field(PreparedRays::near_x)),
                                           fma(near_planes.y, iy, field(PreparedRays::near_y))),
                                       max(fma(near_planes.z, iz, field(PreparedRays::near_z)), Float(0)));
                const Float far =
                    min(min(fma(far_planes.x, ix, field(PreparedRays::far_x)),
                            fma(far_planes.y, iy, field(PreparedRays::far_y))),
                        min(fma(far_planes.z, iz, field(PreparedRays::far_z)), load(memory_.hits.t + k * lanes)));
                meet |= RayMask(mask_bits(near <= far)) << k * lanes;
            }
            meet &= rays;
            memory_.packet_stack[std::size_t(size)] = {meet, node.child[slot], met_t[i]};
            size += meet != 0;
        }
        return size;
    }

    /// Rays that hit one box of a moving node.
    RayMask intersect_moving(const float* bounds, const float* change, RayMask rays) const
    {
        RayMask meet = 0;
        for (int k = 0; k < parts; ++k) {
            if (!holds_any(rays, k)) continue;
            const PreparedRays& r = part(k);
            const Float time = load(memory_.times.shutter + k * lanes);
            Float near(0.f), far = load(memory_.hits.t + k * lanes);
            for (int axis = 0; axis < 3; ++axis) {
                const std::ptrdiff_t near_row = side_[axis], far_row = (2 * axis + 3) * bvh_width - side_[axis];
                const auto plane = [&](std::ptrdiff_t row) {
                    return fma(Float(change[row]), time, Float(bounds[row]));
                };
                const Float inverse = load(r.f[PreparedRays::inverse_x + axis]);
                near = max(near, fma(plane(near_row), inverse, load(r.f[PreparedRays::near_x + axis])));
                far = min(far, fma(plane(far_row), inverse, load(r.f[PreparedRays::far_x + axis])));
            }
            meet |= RayMask(mask_bits(near <= far)) << k * lanes;
        }
        return meet & rays;
    }

    /// Triangles (lanes) whose box may be hit by the rays of the intervals.
    [[gnu::always_inline]] std::uint32_t candidates(const RayIntervals& of, Mask triangles, const Float low[3],
                                                    const Float high[3]) const
    {
        Float near(0), far(of.reach);
        for (int axis = 0; axis < 3; ++axis) {
            const bool down = octant_ >> axis & 1;
            of.distances(axis, down ? high[axis] : low[axis], down ? low[axis] : high[axis], near, far);
        }
        return mask_bits((near <= far) & triangles);
    }

    [[gnu::noinline]] void visit_leaf_apart(std::uint32_t reference, RayMask rays)
    {
        bool found = false;
        for (RayMask m = rays; m; m &= m - 1) {
            const int ray = std::countr_zero(m);
            const bool hit = stream_.intersect_leaf(ray, reference);
            if (any_hit && hit) blocked_ |= RayMask(1) << ray;
            found |= hit;
        }
        if (found && !any_hit) update_reach();
    }

    void visit_leaf(std::uint32_t reference, RayMask rays)
    {
        if (std::popcount(rays) <= few_at_leaf) return visit_leaf_apart(reference, rays);
        const std::ptrdiff_t n = BvhReference::triangle_count(reference);
        const std::uint32_t first = BvhReference::first_triangle(reference);
        const float* const data = &bvh_.triangles[9 * std::size_t(first)];
        memory_.visits.primitives += std::uint64_t(n * std::popcount(rays));
        Float low[3], high[3];
        triangle_boxes(data, n, low, high);
        const Mask triangles = first_lanes(std::size_t(n));
        bool found = false;
        for (int k = 0; k < parts; ++k) {
            const Mask active = part_of(rays & ~blocked_, k);
            if (none(active)) continue;
            if (const std::uint32_t bits = candidates(of_part_[k], triangles, low, high))
                found |= intersect_triangle_leaf(data, n, first, bits, k, active);
        }
        if (found && !any_hit) update_reach();
    }

    /// Intersects one part of the rays with some triangles of a leaf.
    [[gnu::always_inline]] bool intersect_triangle_leaf(const float* data, std::ptrdiff_t n, std::uint32_t first,
                                                        std::uint32_t bits, int k, Mask active)
    {
        const PreparedRays& r = part(k);
        const Vec3 o = load_vec3(r.f[PreparedRays::origin_x + axes_[0]], r.f[PreparedRays::origin_x + axes_[1]],
                                 r.f[PreparedRays::origin_x + axes_[2]]);
        const Float shear_x = load(r.f[PreparedRays::shear_x]), shear_y = load(r.f[PreparedRays::shear_y]);
        bool found = false;
        for (; bits; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const auto corner = [&](std::ptrdiff_t vertex) {
                const float* const p = data + 3 * vertex * n + i;
                return Vec3{Float(p[axes_[0] * n]), Float(p[axes_[1] * n]), Float(p[axes_[2] * n])} - o;
            };
            const Vec3 a = corner(0), b = corner(1), c = corner(2);
            TriangleWeights w = triangle_weights(shear_x, shear_y, a, b, c);
            w.inside &= active;
            if (none(w.inside)) continue;
            if (!take(k, hit_is_index | (first + std::uint32_t(i)), w, {a.z, b.z, c.z})) continue;
            found = true;
            if (any_hit) active = part_of(rays_ & ~blocked_, k) & active;
        }
        return found;
    }

    /// visit_leaf() for an indexed leaf.
    [[gnu::noinline]] void visit_indexed_leaf(std::uint32_t reference, RayMask rays)
    {
        if (!times_.same_key || std::popcount(rays) <= few_at_leaf) return visit_leaf_apart(reference, rays);
        const IndexedLeaf leaf = bvh_.indexed_leaf(reference);
        memory_.visits.primitives += std::uint64_t(leaf.count() * std::popcount(rays));
        Float low[3], high[3];
        times_.bounds<moving>(leaf, low, high);
        bool found = false;
        for (int k = 0; k < parts; ++k) {
            const Mask active = part_of(rays & ~blocked_, k);
            if (none(active)) continue;
            const std::uint32_t bits = candidates(of_part_[k], first_lanes(std::size_t(leaf.count())), low, high);
            if (bits) found |= intersect_triangle_leaf(leaf, bits, k, active);
        }
        if (found && !any_hit) update_reach();
    }

    [[gnu::always_inline]] bool intersect_triangle_leaf(const IndexedLeaf& leaf, std::uint32_t bits, int k, Mask active)
    {
        const PreparedRays& r = part(k);
        const Float fraction = moving ? load(memory_.times.fraction + k * lanes) : Float(0);
        const LeafVertices<moving, Float> vertices(leaf, times_.key, fraction);
        bool found = false;
        for (; bits; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const auto corner = [&](int c) {
                const float* const vertex = leaf.axis(0) + leaf.corners(c)[i];
                const auto coordinate = [&](std::ptrdiff_t axis) {
                    return vertices.one(vertex + axis * leaf.vertices()) - load(r.f[PreparedRays::origin_x + axis]);
                };
                return Vec3{coordinate(axes_[0]), coordinate(axes_[1]), coordinate(axes_[2])};
            };
            const Vec3 a = corner(0), b = corner(1), c = corner(2);
            TriangleWeights w =
                triangle_weights(load(r.f[PreparedRays::shear_x]), load(r.f[PreparedRays::shear_y]), a, b, c);
            w.inside &= active;
            if (none(w.inside)) continue;
            if (!take(k, leaf.ids()[i], w, {a.z, b.z, c.z})) continue;
            found = true;
            if (any_hit) active = part_of(rays_ & ~blocked_, k) & active;
        }
        return found;
    }

    /// Records hits of a part of the rays on one triangle; what: as in RayHits.
    [[gnu::always_inline]] bool take(int k, std::uint32_t what, const TriangleWeights& w, const Vec3& z)
    {
        RayHits& hits = memory_.hits;
        const int base = k * lanes;
        const Float t_max = load(hits.t + base);
        const Float shear_z = load(part(k).f[PreparedRays::shear_z]);
        if (any_hit && !bvh_.has_alpha) {
            const Mask stopped = w.inside & UndividedHits(w, shear_z, z).before(t_max);
            blocked_ |= RayMask(mask_bits(stopped)) << base;
            store(hits.what + base, select(stopped, UInt(0u), load(hits.what + base)));
            return any(stopped);
        }
        Float t, u, v;
        Mask m = triangle_distance(w, shear_z, z, t_max, t, u, v);
        const Mask nearer = m & (t < t_max);
        if (any_hit) m = nearer;
        if (bvh_.has_alpha || any(m & !nearer)) return take_one_by_one(base, what, m, t, u, v);
        if (none(m)) return false;
        store(hits.t + base, select(m, t, t_max));
        store(hits.u + base, select(m, u, load(hits.u + base)));
        store(hits.v + base, select(m, v, load(hits.v + base)));
        store(hits.what + base, select(m, UInt(what), load(hits.what + base)));
        store(hits.instance + base, select(m, UInt(instance()), load(hits.instance + base)));
        return true;
    }

    [[gnu::noinline]] bool take_one_by_one(int base, std::uint32_t what, Mask m, Float t, Float u, Float v)
    {
        alignas(64) float ts[lanes], us[lanes], vs[lanes];
        store(ts, t), store(us, u), store(vs, v);
        const BvhKey key = what & hit_is_index ? bvh_.keys[what & ~hit_is_index] : what;
        bool found = false;
        for_each_active(m, [&](int lane) {
            if (!memory_.hits.is_preceded_by(bvh_, base + lane, ts[lane], us[lane], key, instance())) return;
            if (bvh_.has_alpha &&
                !passes_alpha(bvh_, memory_, base + lane, {key, instance(), ts[lane], us[lane], vs[lane]}))
                return;
            memory_.hits.set(base + lane, ts[lane], us[lane], vs[lane], key, instance());
            if (any_hit) blocked_ |= RayMask(1) << (base + lane);
            found = true;
        });
        return found;
    }

    const BvhData& bvh_;
    StreamMemory& memory_;
    Stream<any_hit, moving>& stream_;
    RayMask rays_, blocked_ = 0;
    Space space_;
    int bottom_;
    std::uint32_t octant_ = 0;
    std::ptrdiff_t side_[3], axes_[3];
    RayIntervals all_, of_part_[parts];
    PacketTimes times_;
};

}  // namespace FATHOM_LANES
}  // namespace fathom
