#pragma once
/// Rays that keep together: one walk through the tree for up to stream_size of them, with vectors of rays.
///
/// They must have the same signs of direction and the same longest axis. A box or triangle is first tested against all
/// rays at once, by intervals that hold their origins and inverse directions; what passes is tested ray by ray. Where
/// few rays are left, the rest of their way is put on their own stacks, to be gone when the walk has found what it can.
#include "geometry/bvh_stream.h"

namespace fathom::inline FATHOM_LANES {

using RayMask = std::uint64_t;
static_assert(stream_size <= 64);

/// Those of the rays that have the octant and axis of the first of them.
inline RayMask alike(const StreamMemory& memory, RayMask rays)
{
    const int first = std::countr_zero(rays);
    const auto of_first = [&](int field) {
        return float_bits(Float(memory.world[first / lanes].f[field][first % lanes]));
    };
    const UInt octant = of_first(PreparedRays::octant), axis = of_first(PreparedRays::axis);
    RayMask same = 0;
    for (int part = 0; part < stream_size / lanes; ++part) {
        const PreparedRays& r = memory.world[part];
        const Mask m = (float_bits(load(r.f[PreparedRays::octant])) == octant) &
                       (float_bits(load(r.f[PreparedRays::axis])) == axis);
        same |= RayMask(mask_bits(m)) << part * lanes;
    }
    return same & rays;
}

template <bool any_hit>
class PacketTraversal {
public:
    /// The rays must be alike, and added to the stream.
    PacketTraversal(const BvhData& bvh, StreamMemory& memory, Stream<any_hit>& stream, RayMask rays)
        : bvh_(bvh), memory_(memory), stream_(stream), rays_(rays)
    {
        const int first = std::countr_zero(rays);
        const PreparedRay r{&memory.world[first / lanes].f[0][first % lanes]};
        for (int k = 0; k < 3; ++k) {
            side_[k] = r.integer(PreparedRays::side_x + k);
            axes_[k] = int(r.integer(PreparedRays::axis) + std::uint32_t(k) + 1) % 3;
        }
        octant_ = r.integer(PreparedRays::octant);
        set_intervals();
        update_reach();
    }

    /// Visits what is worth visiting together; the rest is started in the stream.
    void run()
    {
        PacketEntry* const stack = memory_.packet_stack.data();
        int size = 0;
        stack[size++] = {rays_, bvh_.root, 0};
        while (size > 0) {
            const PacketEntry entry = stack[--size];
            const RayMask rays = entry.rays & reached_by(entry.t);
            if (rays == 0) continue;
            const bool is_node = BvhReference::is_node(entry.reference);
            if (std::popcount(rays) <= few || (!is_node && !BvhReference::is_triangles(entry.reference))) {
                for (RayMask m = rays; m; m &= m - 1) stream_.defer(std::countr_zero(m), entry.reference, entry.t);
            } else if (is_node) {
                size = visit_node(bvh_.nodes[entry.reference], rays, size);
            } else {
                visit_leaf(entry.reference, rays);
            }
        }
        for (RayMask m = rays_ & ~blocked_; m; m &= m - 1) stream_.start(std::countr_zero(m));
    }

private:
    static constexpr int parts = stream_size / lanes;
    static constexpr int few = 3;

    static Mask part_of(RayMask rays, int part)
    {
        return mask_from_bits(std::uint32_t(rays >> part * lanes) & std::uint32_t((RayMask(1) << lanes) - 1));
    }
    const PreparedRays& part(int i) const { return memory_.world[i]; }

    static float least(Float x)
    {
        alignas(64) float lane[lanes];
        store(lane, x);
        float result = lane[0];
        for (float v : lane) result = v < result ? v : result;
        return result;
    }

    void set_intervals()
    {
        for (int axis = 0; axis < 3; ++axis) {
            const Float none(infinity);
            Float low_inverse = none, high_inverse = none, low = none, high = none;  // the high ones negated
            for (int i = 0; i < parts; ++i) {
                const Mask m = part_of(rays_, i);
                const Vec3 o = load_vec3(part(i).f[PreparedRays::origin_x], part(i).f[PreparedRays::origin_y],
                                         part(i).f[PreparedRays::origin_z]);
                const Float inverse = load(part(i).f[PreparedRays::inverse_x + axis]);
                const Float x = load(part(i).f[PreparedRays::origin_x + axis]), slack = ray_slack(o, bvh_.radius);
                low_inverse = min(low_inverse, select(m, inverse, none));
                high_inverse = min(high_inverse, select(m, -inverse, none));
                low = min(low, select(m, x - slack, none));
                high = min(high, select(m, -(x + slack), none));
            }
            low_inverse_[axis] = least(low_inverse);
            high_inverse_[axis] = -least(high_inverse);
            const float from = least(low), to = -least(high);
            const bool down = octant_ >> axis & 1;
            near_origin_[axis] = down ? from : to;
            far_origin_[axis] = down ? to : from;
        }
    }

    /// Rays that might find something at t or beyond.
    RayMask reached_by(float t) const
    {
        RayMask rays = 0;
        for (int i = 0; i < parts; ++i)
            rays |= RayMask(mask_bits(Float(t) <= load(memory_.hits.t + i * lanes))) << i * lanes;
        return rays & ~blocked_;
    }

    void update_reach()
    {
        Float low(infinity);
        for (int i = 0; i < parts; ++i)
            low = min(low, select(part_of(rays_, i), -load(memory_.hits.t + i * lanes), low));
        reach_ = -least(low);
    }

    /// The distances that any of the rays could have to boxes.
    [[gnu::always_inline]] void intervals(int axis, Float near_plane, Float far_plane, Float& near, Float& far) const
    {
        const Float lo(low_inverse_[axis]), hi(high_inverse_[axis]);
        const Float a = near_plane - Float(near_origin_[axis]), b = far_plane - Float(far_origin_[axis]);
        near = max(near, min(a * lo, a * hi));
        far = min(far, max(b * lo, b * hi));
    }

    int visit_node(const BvhNode& node, RayMask rays, int size)
    {
        const float* const bounds = node.bounds[0];
        BoxDistances box;
        for (int k = 0; k < box_parts; ++k) {
            box.near[k] = Float(0);
            box.far[k] = Float(reach_);
            for (int axis = 0; axis < 3; ++axis) {
                const float* const p = bounds + k * lanes;
                intervals(axis, load(p + side_[axis]), load(p + (2 * axis + 3) * bvh_width - side_[axis]), box.near[k],
                          box.far[k]);
            }
        }
        static constexpr std::array<std::uint32_t, bvh_width> slots = {0, 1, 2,  3,  4,  5,  6,  7,
                                                                       8, 9, 10, 11, 12, 13, 14, 15};
        alignas(64) static constexpr auto aligned_slots = slots;
        alignas(64) std::uint32_t met[2 * bvh_width];
        alignas(64) float met_t[2 * bvh_width];
        const int count = push_in_order({met, met_t}, 0, aligned_slots.data(), node.order[octant_], box);
        for (int i = 0; i < count; ++i) {
            const std::uint32_t slot = met[i];
            const auto plane = [&](std::ptrdiff_t side) { return Float(bounds[std::ptrdiff_t(slot) + side]); };
            constexpr std::ptrdiff_t row = bvh_width;
            const Vec3 near_planes{plane(side_[0]), plane(side_[1]), plane(side_[2])};
            const Vec3 far_planes{plane(3 * row - side_[0]), plane(5 * row - side_[1]), plane(7 * row - side_[2])};
            RayMask meet = 0;
            for (int k = 0; k < parts; ++k) {
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

    /// Lanes are triangles here: which of them could be met.
    [[gnu::always_inline]] std::uint32_t candidates(const float* data, std::ptrdiff_t n) const
    {
        Float near(0.f), far(reach_);
        for (int axis = 0; axis < 3; ++axis) {
            const float* const p = data + axis * n;
            const Float a = load(p), b = load(p + 3 * n), c = load(p + 6 * n);
            const Float low = min(min(a, b), c), high = max(max(a, b), c);
            const bool down = octant_ >> axis & 1;
            intervals(axis, down ? high : low, down ? low : high, near, far);
        }
        return mask_bits((near <= far) & first_lanes(std::size_t(n)));
    }

    void visit_leaf(std::uint32_t reference, RayMask rays)
    {
        const std::ptrdiff_t n = BvhReference::triangle_count(reference);
        const std::uint32_t first = BvhReference::first_triangle(reference);
        const float* const data = &bvh_.triangles[9 * std::size_t(first)];
        bool found = false;
        for (std::uint32_t bits = candidates(data, n); bits; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            const auto corner = [&](std::ptrdiff_t k) {
                const float* const p = data + 3 * k * n + i;
                return Vec3{Float(p[axes_[0] * n]), Float(p[axes_[1] * n]), Float(p[axes_[2] * n])};
            };
            const Vec3 a = corner(0), b = corner(1), c = corner(2);
            for (int k = 0; k < parts; ++k) {
                const Mask active = part_of(rays & ~blocked_, k);
                if (none(active)) continue;
                const PreparedRays& r = part(k);
                const Vec3 o = load_vec3(r.f[PreparedRays::origin_x + axes_[0]], r.f[PreparedRays::origin_x + axes_[1]],
                                         r.f[PreparedRays::origin_x + axes_[2]]);
                const Vec3 pa = a - o, pb = b - o, pc = c - o;
                TriangleWeights w =
                    triangle_weights(load(r.f[PreparedRays::shear_x]), load(r.f[PreparedRays::shear_y]), pa, pb, pc);
                w.inside &= active;
                if (none(w.inside)) continue;
                found |= take(k, first + std::uint32_t(i), w, {pa.z, pb.z, pc.z});
            }
        }
        if (found && !any_hit) update_reach();
    }

    /// The hits of a part of the rays with one triangle.
    [[gnu::always_inline]] bool take(int k, std::uint32_t place, const TriangleWeights& w, const Vec3& z)
    {
        RayHits& hits = memory_.hits;
        const int base = k * lanes;
        const Float t_max = load(hits.t + base);
        Float t, u, v;
        Mask m = triangle_distance(w, load(part(k).f[PreparedRays::shear_z]), z, t_max, t, u, v);
        const Mask nearer = m & (t < t_max);
        if (any_hit) m = nearer;
        if (bvh_.has_alpha || (!any_hit && any(m & !nearer))) return take_one_by_one(base, place, m, t, u, v);
        if (none(m)) return false;
        if (any_hit) {
            blocked_ |= RayMask(mask_bits(m)) << base;
            store(hits.what + base, select(m, UInt(0u), load(hits.what + base)));
        } else {
            store(hits.t + base, select(m, t, t_max));
            store(hits.u + base, select(m, u, load(hits.u + base)));
            store(hits.v + base, select(m, v, load(hits.v + base)));
            store(hits.what + base, select(m, UInt(hit_is_place | place), load(hits.what + base)));
            store(hits.instance + base, select(m, UInt(no_index), load(hits.instance + base)));
        }
        return true;
    }

    [[gnu::noinline]] bool take_one_by_one(int base, std::uint32_t place, Mask m, Float t, Float u, Float v)
    {
        alignas(64) float ts[lanes], us[lanes], vs[lanes];
        store(ts, t), store(us, u), store(vs, v);
        const BvhKey key = bvh_.keys[place];
        bool found = false;
        for_each_active(m, [&](int lane) {
            if (!memory_.hits.loses_to(bvh_, base + lane, ts[lane], key, no_index)) return;
            if (bvh_.has_alpha && !passes_alpha(bvh_, key, no_index, us[lane], vs[lane])) return;
            memory_.hits.set(base + lane, ts[lane], us[lane], vs[lane], key, no_index);
            if (any_hit) blocked_ |= RayMask(1) << (base + lane);
            found = true;
        });
        return found;
    }

    const BvhData& bvh_;
    StreamMemory& memory_;
    Stream<any_hit>& stream_;
    RayMask rays_, blocked_ = 0;
    std::uint32_t octant_ = 0;
    std::ptrdiff_t side_[3];
    int axes_[3];
    /// Of all the rays: inverse directions, and origins, widened by the slack, whose distance is least and greatest.
    float low_inverse_[3], high_inverse_[3], near_origin_[3], far_origin_[3];
    float reach_ = 0;
};

}  // namespace fathom::inline FATHOM_LANES
