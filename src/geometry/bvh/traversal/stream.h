// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Stream traversal: several dozen rays at once, each on its own path through the tree.
///
/// A single ray waits for memory, for the long dependency chain from node to node, and for mispredicted branches. Here
/// a wave advances each ray by one node, without branches that depend on the ray; in large trees the nodes of the next
/// wave are prefetched meanwhile. Rays that reach a leaf wait for the wave of leaves. Each ray visits the same nodes in
/// the same order as it would alone.
#include <array>
#include <iterator>
#include <utility>

#include "geometry/bvh/builder/boxes.h"
#include "geometry/bvh/layout/indexed.h"
#include "geometry/bvh/traversal/hits.h"
#include "geometry/bvh/traversal/leaves.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// moving: whether anything in the scene moves; streams through static scenes skip the test.
template <bool any_hit, bool moving>
class Stream {
public:
    Stream(const BvhData& bvh, StreamMemory& memory)
        : bvh_(bvh),
          far_(bvh.far),
          has_meshes_(!bvh.meshes.empty()),
          memory_(memory),
          stride_((std::size_t(bvh.stack_size) + line_words - 1) / line_words * line_words)
    {
        memory.packet_stack.resize(std::max(memory.packet_stack.size(), stride_));
        memory.stacks.resize(std::max(memory.stacks.size(), stream_size * words_of_a_ray() + line_words));
        const std::size_t past =
            reinterpret_cast<std::uintptr_t>(memory.stacks.data()) / sizeof(std::uint32_t) % line_words;
        stacks_ = memory.stacks.data() + (line_words - past) % line_words;
    }

    /// Starts a ray of memory.world at the root.
    void begin(int ray)
    {
        add(ray);
        queue(ray, bvh_.root, next_.n);
    }
    /// Defers a subtree, whose box has entry distance t; returns false if the ray's stack is full.
    bool defer(int ray, std::uint32_t reference, float t)
    {
        if (!is_known(ray)) add(ray);
        if (size(ray) > bvh_deferred) return false;
        push(ray, reference, t);
        waiting_ |= RayMask(1) << ray;
        return true;
    }
    /// Continues the ray in the space of an instance until the `end` that is pushed here is popped.
    void enter(int ray, std::uint32_t instance, const float* prepared_there)
    {
        if (!is_known(ray)) add(ray);
        states_[ray].prepared = prepared_there;
        states_[ray].instance = instance;
        push(ray, end, -infinity);
    }
    /// Rays with subtrees deferred since they were last started.
    RayMask waiting() const { return waiting_; }
    /// Starts visiting the deferred subtrees that are not beyond the current hit, the last first.
    void start(int ray)
    {
        waiting_ &= ~(RayMask(1) << ray);
        if (!any_hit) remove_beyond(ray, memory_.hits.t[ray]);
        pop(ray, next_.n);
    }

    /// Resets rays that have been traced, so that they can be deferred again in world space.
    void forget(RayMask rays) { known_ &= ~rays; }

    /// Tests a leaf of triangles immediately; returns whether it contains the nearest hit so far.
    bool intersect_leaf(int ray, std::uint32_t reference)
    {
        if (!is_known(ray)) add(ray);
        states_[ray].reference = reference;
        const int n = triangle_count(reference);
        memory_.visits.primitives += std::uint64_t(n);
        bool found = false;
        for (int at = 0; at < n && !(any_hit && found); at += lanes) {
            const TriangleIntersections triangles = intersect_leaf_triangles(ray, at);
            if (any(triangles.weights.inside)) found |= take_triangles(ray, at, triangles);
        }
        return found;
    }

    /// Traces all rays that were started, and updates memory.hits.
    void run()
    {
        while (next_.n > 0) {
            sort();
            visit_nodes();
            if constexpr (lanes == bvh_width) {
                for (int i = 0; i < std::min(leaf_wave, now_.n.leaves); ++i) fetch_leaf(now_.leaf[i]);
                if (any_hit && !bvh_.has_alpha) {
                    visit_leaves_for_any();
                } else {
                    for (int i = 0; i < now_.n.leaves; i += leaf_wave)
                        visit_leaves(i, std::min(i + leaf_wave, now_.n.leaves));
                }
            } else {
                for (int i = 0; i < now_.n.leaves; ++i) visit_leaf(int(now_.leaf[i]));
            }
            if (now_.n.others > 0) visit_others();
        }
    }

private:
    static constexpr std::uint32_t end = BvhReference::others(BvhReference::end, 0);
    /// Number of leaves tested at a time; also how far ahead leaves are prefetched.
    static constexpr int leaf_wave = 8;
    /// Nodes are prefetched this many rays ahead. A smaller number hides less latency, a larger one crowds the load
    /// queues.
    static constexpr int ahead = 4;

    /// Number of words in a cache line. Stacks start at a line, so that their entries touch few lines, and lie an odd
    /// number of lines apart: at powers of two they would evict each other from the cache.
    static constexpr std::size_t line_words = 16;

    /// Numbers of rays in the queues.
    struct Counts {
        int nodes = 0, leaves = 0, others = 0;
    };
    /// Indices of rays, padded for vector stores.
    using RayList = std::uint32_t[stream_size + lanes];
    /// Rays by kind of reference to visit: a node, a leaf of triangles, or anything else.
    struct Queues {
        Counts n;
        RayList node, leaf, other;
    };
    /// Rays that continue, and the reference each visits next.
    struct NextVisits {
        int n = 0;
        RayList ray, reference;
    };

    /// Distributes the rays that continue to the queues by kind of reference, a vector at a time.
    void sort()
    {
        Counts n;
        for (int i = 0; i < next_.n; i += lanes) {
            const UInt ray = load(next_.ray + i), reference = load(next_.reference + i), kind = reference >> 29;
            // Outside instances, the end of a ray's stack ends the ray.
            const Mask goes_on = first_lanes(std::size_t(next_.n - i)) & (has_meshes_ | (reference != UInt(end)));
            const Mask node = kind == UInt(0u), leaf = less(UInt(2u), kind), other = goes_on & !(node | leaf);
            const auto put = [&](RayList& list, int& size, Mask m) {
                compress_store(list + size, ray, m);
                size += count(m);
            };
            put(now_.node, n.nodes, goes_on & node);
            put(now_.leaf, n.leaves, goes_on & leaf);
            if (any(other)) put(now_.other, n.others, other);
        }
        now_.n = n;
        next_.n = 0;
    }

    /// Traversal state of a ray.
    struct State {
        const float* prepared;  ///< in memory.world or, within an instance, in memory.object
        std::uint32_t* top;     ///< top of the stack of references; their distances are stride_ words further
        std::uint32_t reference, instance;
        std::uint32_t* bottom;
    };

    /// Initializes a ray without any work.
    void add(int ray)
    {
        std::uint32_t* const bottom = stacks_ + std::size_t(ray) * words_of_a_ray();
        states_[ray] = {&memory_.world[ray / lanes].f[0][ray % lanes], bottom, end, no_index, bottom};
        push(ray, end, -infinity);
        known_ |= RayMask(1) << ray;
        waiting_ &= ~(RayMask(1) << ray);
    }
    std::size_t words_of_a_ray() const { return 2 * stride_ + line_words; }
    bool is_known(int ray) const { return known_ >> ray & 1; }

    PreparedRay prepared(int ray) const { return {states_[ray].prepared}; }
    BvhStack stack(int ray) const { return {states_[ray].bottom, distances(states_[ray].bottom)}; }
    float* distances(std::uint32_t* references) const { return reinterpret_cast<float*>(references + stride_); }
    int size(int ray) const { return int(states_[ray].top - states_[ray].bottom); }
    void push(int ray, std::uint32_t reference, float t)
    {
        std::uint32_t* const top = states_[ray].top++;
        *top = reference;
        *distances(top) = t;
    }
    void remove_beyond(int ray, float t) { states_[ray].top = states_[ray].bottom + filter(stack(ray), size(ray), t); }

    std::size_t node_of(int ray) const
    {
        return moving ? BvhReference::node(states_[ray].reference) : states_[ray].reference;
    }

    /// Prefetches the node that a ray visits next.
    [[gnu::always_inline]] void fetch_node(int ray) const
    {
        if (!far_) return;
        const char* const p = reinterpret_cast<const char*>(&bvh_.nodes[node_of(ray)]);
        for (int line = 0; line < 8; ++line) __builtin_prefetch(p + 64 * line);
        if (moving && BvhReference::is_moving(states_[ray].reference))
            for (int line = 8; line < 14; ++line) __builtin_prefetch(p + 64 * line);
    }
    [[gnu::always_inline]] void fetch_other(int ray) const
    {
        if (!far_) return;
        const std::uint32_t reference = states_[ray].reference;
        if (BvhReference::other_kind(reference) == BvhReference::end) return;
        const bool placed = BvhReference::other_kind(reference) == BvhReference::instance;
        const std::size_t place = BvhReference::place(reference);
        const auto* const p = placed ? reinterpret_cast<const char*>(&bvh_.tables->instances[place])
                                     : reinterpret_cast<const char*>(&bvh_.others[place * BvhLeaf::unit]);
        for (int line = 0; line < (placed ? 1 : 10); ++line) __builtin_prefetch(p + 64 * line);
    }
    [[gnu::always_inline]] void fetch_leaf(int ray) const
    {
        if (!far_) return;
        const std::uint32_t reference = states_[ray].reference;
        const auto* const p = is_indexed(reference)
                                  ? reinterpret_cast<const char*>(indexed_leaf(reference).words)
                                  : reinterpret_cast<const char*>(
                                        &bvh_.triangles[9 * std::size_t(BvhReference::first_triangle(reference))]);
        for (int line = 0; line < 6; ++line) __builtin_prefetch(p + 64 * line);
    }

    /// Records the next visit of a ray. `really` is 0 or 1; 0 has no effect, which saves a branch.
    [[gnu::always_inline]] void queue(int ray, std::uint32_t reference, int& n, int really = 1)
    {
        states_[ray].reference = reference;
        next_.ray[n] = std::uint32_t(ray);
        next_.reference[n] = reference;
        n += really;
    }

    [[gnu::always_inline]] void pop(int ray, int& n, int really = 1)
    {
        queue(ray, *(states_[ray].top -= really), n, really);
    }

    void visit_nodes()
    {
        memory_.visits.nodes += std::uint64_t(now_.n.nodes);
        for (int i = 0; i < now_.n.nodes; ++i) {
            fetch_node(int(now_.node[std::min(i + ahead, now_.n.nodes - 1)]));
            visit_node(int(now_.node[i]));
        }
        // Rays pop in a separate loop, since values just stored on a stack cannot be loaded without a delay.
        int n = next_.n;
        for (int i = 0; i < now_.n.nodes; ++i) pop(int(now_.node[i]), n);
        next_.n = n;
    }

    [[gnu::always_inline]] void visit_node(int ray)
    {
        const PreparedRay r = prepared(ray);
        const BvhNode& node = bvh_.nodes[node_of(ray)];
        if constexpr (moving)
            if (BvhReference::is_moving(states_[ray].reference)) return visit_moving_node(ray, r, node);
        const BoxDistances box = distances_to(node, r, Float(memory_.hits.t[ray]));
        std::uint32_t*& top = states_[ray].top;
        const BvhStack above{top, distances(top)};
        top += any_hit ? push_any(above, 0, node, box)
                       : push_in_order(above, 0, node.child, node.order[r.integer(PreparedRays::octant)], box);
    }

    /// visit_node() for moving boxes.
    [[gnu::noinline]] void visit_moving_node(int ray, const PreparedRay& r, const BvhNode& node)
    {
        const BoxDistances box =
            distances_to_moving(node, r, Float(memory_.times.shutter[ray]), Float(memory_.hits.t[ray]));
        std::uint32_t*& top = states_[ray].top;
        const BvhStack above{top, distances(top)};
        const std::uint32_t* order = node.order[r.integer(PreparedRays::octant)];
        top += any_hit ? push_any(above, 0, node, box) : push_in_order(above, 0, node.child, order, box);
    }

    /// Leaves of triangles may have either layout.
    static bool is_indexed(std::uint32_t leaf) { return BvhReference::is_indexed_triangles(leaf); }
    IndexedLeaf indexed_leaf(std::uint32_t reference) const { return bvh_.indexed_leaf(reference); }
    int triangle_count(std::uint32_t leaf) const { return bvh_.triangle_count(leaf); }
    BvhKey triangle_key(std::uint32_t leaf, int i) const
    {
        return is_indexed(leaf) ? indexed_leaf(leaf).ids()[i]
                                : bvh_.keys[BvhReference::first_triangle(leaf) + std::uint32_t(i)];
    }
    /// Returns the value of RayHits::what for triangle i of a leaf.
    std::uint32_t hit_id_of(std::uint32_t leaf, int i) const
    {
        return is_indexed(leaf) ? triangle_key(leaf, i)
                                : hit_is_index | (BvhReference::first_triangle(leaf) + std::uint32_t(i));
    }

    [[gnu::always_inline]] TriangleIntersections intersect_leaf_triangles(int ray, int at) const
    {
        const std::uint32_t leaf = states_[ray].reference;
        if (!is_indexed(leaf)) return intersect_triangles(bvh_, leaf, at, prepared(ray));
        const std::uint32_t key = moving ? memory_.times.key[ray] : 0;
        const float fraction = moving ? memory_.times.fraction[ray] : 0;
        return intersect_triangles<moving>(indexed_leaf(leaf), key, fraction, at, prepared(ray));
    }

    /// Branch-free, since hits are unpredictable. The work is split in steps because each step of one ray depends on
    /// the previous; within a step the rays are independent.
    void visit_leaves(int first, int last)
    {
        TriangleDistances to[leaf_wave];
        std::uint8_t found[leaf_wave];
        int triangles = 0;
        int n = next_.n;
        for (int i = first; i < last; ++i) {
            const int ray = int(now_.leaf[i]);
            fetch_leaf(now_.leaf[std::min(i + leaf_wave, now_.n.leaves - 1)]);
            triangles += triangle_count(states_[ray].reference);
            to[i - first] = distances_to_triangles(ray, intersect_leaf_triangles(ray, 0));
        }
        // Rays with hits are listed without branches first: half of the leaves have no hit, which is unpredictable.
        std::uint32_t nearer[leaf_wave];
        int nearer_count = 0;
        for (int i = first; i < last; ++i) {
            found[i - first] = note_nearest(int(now_.leaf[i]), to[i - first]);
            nearer[nearer_count] = now_.leaf[i];
            nearer_count += found[i - first];
        }
        if (!any_hit)
            for (int i = 0; i < nearer_count; ++i) remove_beyond(int(nearer[i]), memory_.hits.t[nearer[i]]);
        for (int i = first; i < last; ++i) pop(int(now_.leaf[i]), n, any_hit ? 1 - found[i - first] : 1);
        memory_.visits.primitives += std::uint64_t(triangles);
        next_.n = n;
    }

    /// visit_leaves() for occlusion rays, where one bit per leaf suffices: a single step takes a fifth less time.
    void visit_leaves_for_any()
    {
        std::uint8_t found[stream_size];
        int triangles = 0;
        int n = next_.n;
        for (int i = 0; i < now_.n.leaves; ++i) {
            const int ray = int(now_.leaf[i]);
            fetch_leaf(now_.leaf[std::min(i + leaf_wave, now_.n.leaves - 1)]);
            triangles += triangle_count(states_[ray].reference);
            found[i] = any(blockers(ray, intersect_leaf_triangles(ray, 0)));
        }
        for (int i = 0; i < now_.n.leaves; ++i) {
            const int ray = int(now_.leaf[i]);
            memory_.hits.what[ray] = found[i] ? 0 : memory_.hits.what[ray];
            pop(ray, n, 1 - found[i]);
        }
        memory_.visits.primitives += std::uint64_t(triangles);
        next_.n = n;
    }

    struct TriangleDistances {
        Float t, u, v;
        Mask hit;
    };
    /// Distances of a ray to the triangles that its line passes through.
    [[gnu::always_inline]] TriangleDistances distances_to_triangles(int ray, const TriangleIntersections& weighed) const
    {
        const Float t_max(memory_.hits.t[ray]), shear_z(prepared(ray).number(PreparedRays::shear_z));
        TriangleDistances to;
        to.hit = triangle_distance(weighed.weights, shear_z, weighed.corners_z, t_max, to.t, to.u, to.v);
        if (any_hit) to.hit &= to.t < t_max;
        return to;
    }

    /// The triangles that block a ray.
    [[gnu::always_inline]] Mask blockers(int ray, const TriangleIntersections& weighed) const
    {
        const Float shear_z(prepared(ray).number(PreparedRays::shear_z));
        return weighed.weights.inside &
               UndividedHits(weighed.weights, shear_z, weighed.corners_z).before(Float(memory_.hits.t[ray]));
    }

    /// Records the nearest hit on a leaf of at most `lanes` triangles; returns whether there is one.
    [[gnu::always_inline]] bool note_nearest(int ray, const TriangleDistances& to)
    {
        RayHits& hits = memory_.hits;
        const std::uint32_t met = mask_bits(to.hit);
        const float t = first_of(to.t, to.hit);
        if (bvh_.has_alpha || (met & (met - 1)) != 0 || t == hits.t[ray]) return note_nearest_of_some(ray, to);
        // Without a hit, the values go to an unused slot.
        const int at = met != 0 ? ray : RayHits::discard_slot;
        const int lane = std::countr_zero(met | 1u << (lanes - 1));
        hits.set(at, t, first_of(to.u, to.hit), first_of(to.v, to.hit), hit_id_of(states_[ray].reference, lane),
                 states_[ray].instance);
        return met != 0;
    }

    /// note_nearest() for several hits (such as both sides of a thin object), ties, or alpha tests.
    [[gnu::noinline]] bool note_nearest_of_some(int ray, TriangleDistances to)
    {
        const std::uint32_t leaf = states_[ray].reference, least = min_lanes(to.hit, to.t);
        const Mask nearest = mask_from_bits(least);
        const float t = first_of(to.t, nearest);
        if (least == 0) return false;
        if (bvh_.has_alpha || !std::has_single_bit(least) || t == memory_.hits.t[ray])
            return take(ray, to.hit, to.t, to.u, to.v, [&](int lane) { return triangle_key(leaf, lane); });
        memory_.hits.set(ray, t, first_of(to.u, nearest), first_of(to.v, nearest),
                         hit_id_of(leaf, std::countr_zero(least)), states_[ray].instance);
        return true;
    }

    /// Visits one leaf; used where a vector has fewer lanes than a node has children.
    void visit_leaf(int ray) { go_on(ray, intersect_leaf(ray, states_[ray].reference)); }

    [[gnu::always_inline]] bool take_triangles(int ray, int at, const TriangleIntersections& weighed)
    {
        if (any_hit && !bvh_.has_alpha) {
            if (none(blockers(ray, weighed))) return false;
            memory_.hits.what[ray] = 0;
            return true;
        }
        const auto [t, u, v, m] = distances_to_triangles(ray, weighed);
        if (none(m)) return false;
        return take(ray, m, t, u, v, [&](int lane) { return triangle_key(states_[ray].reference, at + lane); });
    }

    /// Continues a ray after a leaf: removes stack entries beyond a new hit.
    void go_on(int ray, bool found)
    {
        if (found && any_hit) return;
        if (found) remove_beyond(ray, memory_.hits.t[ray]);
        pop(ray, next_.n);
    }

    /// Tests the hits of some lanes one by one; returns whether one is the nearest so far.
    template <class Key>
    bool take(int ray, Mask m, Float t, Float u, Float v, const Key& key_of)
    {
        alignas(64) float ts[lanes], us[lanes], vs[lanes];
        store(ts, t), store(us, u), store(vs, v);
        bool found = false;
        RayHits& hits = memory_.hits;
        for_each_active(m, [&](int lane) {
            const BvhKey key = key_of(lane);
            if (!hits.is_preceded_by(bvh_, ray, ts[lane], us[lane], key, states_[ray].instance)) return;
            if (bvh_.has_alpha &&
                !passes_alpha(bvh_, memory_, ray, {key, states_[ray].instance, ts[lane], us[lane], vs[lane]}))
                return;
            hits.set(ray, ts[lane], us[lane], vs[lane], key, states_[ray].instance);
            found = true;
        });
        return found;
    }

    [[gnu::noinline]] void visit_others()
    {
        for (int i = 0; i < std::min(ahead, now_.n.others); ++i) fetch_other(int(now_.other[i]));
        RayList entering;
        int n = 0;
        for (int i = 0; i < now_.n.others; ++i) {
            fetch_other(int(now_.other[std::min(i + ahead, now_.n.others - 1)]));
            const int ray = int(now_.other[i]);
            if (!moving || BvhReference::other_kind(states_[ray].reference) != BvhReference::instance) {
                visit_other(ray);
                continue;
            }
            entering[n++] = std::uint32_t(ray);
            if (n == lanes) enter_instances(entering, std::exchange(n, 0));
        }
        if (n > 0) enter_instances(entering, n);
    }

    void visit_other(int ray)
    {
        const std::uint32_t reference = states_[ray].reference;
        switch (BvhReference::other_kind(reference)) {
            case BvhReference::instance:
                return enter_instance(ray, BvhReference::place(reference));
            case BvhReference::end:
                if (states_[ray].instance != no_index) leave_instance(ray);
                return;
            default:
                return go_on(ray, visit_other_leaf(ray, BvhReference::other_kind(reference)));
        }
    }

    /// Tests a leaf of primitives other than triangles; returns whether it contains the nearest hit so far.
    bool visit_other_leaf(int ray, BvhReference::Kind kind)
    {
        const BvhLeaf leaf{&bvh_.others[std::size_t(BvhReference::place(states_[ray].reference)) * BvhLeaf::unit]};
        const GeometryTables& tables = *bvh_.tables;
        memory_.visits.primitives += std::uint64_t(leaf.count());
        /// Offers hits on primitives whose key is first + factor * id.
        const auto offer_keys = [&](std::uint32_t first, std::uint32_t factor) {
            return [this, ray, leaf, first, factor](int at, Mask m, Float t, Float u, Float v) {
                const Float nearest(memory_.hits.t[ray]);
                m &= any_hit ? t < nearest : t <= nearest;
                if (none(m)) return false;
                return take(ray, m, t, u, v, [&](int lane) { return first + factor * leaf.ids()[at + lane]; });
            };
        };
        LeafRay r(prepared(ray), states_[ray].instance != no_index, memory_.hits.t[ray]);
        if constexpr (moving) r.key = memory_.times.key[ray], r.fraction = memory_.times.fraction[ray];
        switch (kind) {
            case BvhReference::spheres:
                return intersect_spheres<any_hit>(tables, leaf, r, offer_keys(2 * tables.first_sphere(), 2));
            case BvhReference::disks:
                return intersect_disks<any_hit>(tables, leaf, r, offer_keys(2 * tables.first_disk(), 2));
            case BvhReference::curves:
                return intersect_curves<any_hit, false, moving>(tables, leaf, r,
                                                                offer_keys(2 * tables.first_curve(), 2));
            case BvhReference::ribbons:
                return intersect_curves<any_hit, true, moving>(tables, leaf, r,
                                                               offer_keys(2 * tables.first_curve(), 2));
            default:
                return intersect_points<any_hit>(leaf, r, offer_keys(2 * tables.first_point(), 2));
        }
    }

    /// Continues the ray in the mesh's space until the `end` pushed here is popped.
    void enter_instance(int ray, std::uint32_t index)
    {
        const InstanceRecord& placed = bvh_.tables->instances[index];
        const BvhData::Mesh& mesh = bvh_.meshes[placed.mesh_shape];
        const PreparedRay r = prepared(ray);
        const Affine to_object = object_from_render(*bvh_.tables, placed, Float(0.f));
        const Vec3 o = to_object.point(r.vector(PreparedRays::origin_x));
        const Vec3 d = to_object.vector(r.vector(PreparedRays::direction_x));
        PreparedRays inner;
        inner.prepare(o, d, Float(memory_.hits.t[ray]), Float(r.number(PreparedRays::time)), mesh.radius);
        PreparedRays& object = memory_.object[ray / lanes];
        for (int field = 0; field < PreparedRays::field_count; ++field)
            object.f[field][ray % lanes] = inner.f[field][0];
        enter(ray, index, &object.f[0][ray % lanes]);
        queue(ray, mesh.root, next_.n);
    }

    /// enter_instance() for instances that may move. Interpolating poses is expensive, so a vector of rays is processed
    /// at once.
    [[gnu::noinline]] void enter_instances(const std::uint32_t* rays, int count)
    {
        constexpr int copied[] = {PreparedRays::origin_x,    PreparedRays::origin_y,    PreparedRays::origin_z,
                                  PreparedRays::direction_x, PreparedRays::direction_y, PreparedRays::direction_z,
                                  PreparedRays::time};
        alignas(64) float in[std::size(copied)][lanes] = {}, t_max[lanes] = {}, radius[lanes] = {};
        alignas(64) std::uint32_t index[lanes] = {};
        for (int i = 0; i < count; ++i) {
            const PreparedRay r = prepared(rays[i]);
            for (std::size_t k = 0; k < std::size(copied); ++k) in[k][i] = r.number(copied[k]);
            t_max[i] = memory_.hits.t[rays[i]];
            index[i] = BvhReference::place(states_[rays[i]].reference);
            radius[i] = mesh_of(index[i]).radius;
        }
        const Float time = load(in[6]);
        const Affine to_object = object_from_render(*bvh_.tables, load(index), time, first_lanes(std::size_t(count)));
        PreparedRays inner;
        inner.prepare(to_object.point(load_vec3(in[0], in[1], in[2])), to_object.vector(load_vec3(in[3], in[4], in[5])),
                      load(t_max), time, load(radius));
        for (int i = 0; i < count; ++i) {
            const int ray = int(rays[i]);
            PreparedRays& object = memory_.object[ray / lanes];
            for (int field = 0; field < PreparedRays::field_count; ++field)
                object.f[field][ray % lanes] = inner.f[field][i];
            enter(ray, index[i], &object.f[0][ray % lanes]);
            queue(ray, mesh_of(index[i]).root, next_.n);
        }
    }
    const BvhData::Mesh& mesh_of(std::uint32_t instance) const
    {
        return bvh_.meshes[bvh_.tables->instances[instance].mesh_shape];
    }

    void leave_instance(int ray)
    {
        states_[ray].prepared = &memory_.world[ray / lanes].f[0][ray % lanes];
        states_[ray].instance = no_index;
        pop(ray, next_.n);
    }

    const BvhData& bvh_;
    const bool far_;
    const Mask has_meshes_;  ///< all lanes or none
    StreamMemory& memory_;
    const std::size_t stride_;
    std::uint32_t* stacks_;  ///< first whole cache line of memory.stacks
    Queues now_;
    NextVisits next_;
    RayMask known_ = 0, waiting_ = 0;  ///< rays with initialized state, and rays with deferred subtrees
    State states_[stream_size];
};

}  // namespace FATHOM_LANES
}  // namespace fathom
