#pragma once
/// One ray through the tree, all boxes of a node and all primitives of a leaf at once.
#include "geometry/bvh_push.h"
#include "geometry/bvh_ray.h"

namespace fathom::inline FATHOM_LANES {

/// The nearest hit so far: the least of (t, key, instance).
struct SingleHit {
    float t, u = 0, v = 0;
    BvhKey key = no_index;
    std::uint32_t instance = no_index;

    bool loses_to(float other_t, BvhKey other_key, std::uint32_t other_instance) const
    {
        if (other_t != t) return other_t < t;
        if (key == no_index || other_key != key) return key != no_index && other_key < key;
        return other_instance < instance;
    }
};

/// Whether a hit counts.
inline bool passes_alpha(const BvhData& bvh, BvhKey key, std::uint32_t instance, float u, float v)
{
    const SceneTables& tables = *bvh.tables;
    const std::uint32_t shape =
        instance == no_index ? tables.shape_of_primitive[key >> 1] : tables.instances[instance].shape;
    if (!(tables.shapes[shape].flags & ShapeTable::alpha_tested)) return true;
    if (key & 1) u = 1 - u, v = 1 - v;
    return bvh.alpha_test(bvh.alpha_context, key >> 1, instance, u, v);
}

/// Brings the lines of a node or leaf into the cache.
[[gnu::always_inline]] inline void prefetch(const BvhData& bvh, std::uint32_t reference)
{
    if (BvhReference::is_node(reference)) {
        const char* p = reinterpret_cast<const char*>(&bvh.nodes[reference]);
        for (int line = 0; line < 8; ++line) __builtin_prefetch(p + 64 * line);
    } else if (BvhReference::is_triangles(reference)) {
        const char* p =
            reinterpret_cast<const char*>(&bvh.triangles[9 * std::size_t(BvhReference::first_triangle(reference))]);
        const int bytes = 36 * BvhReference::triangle_count(reference);
        for (int at = 0; at < bytes; at += 64) __builtin_prefetch(p + at);
    }
}

template <bool any_hit>
class SingleTraversal {
public:
    SingleTraversal(const BvhData& bvh, const PreparedRays& rays, int i, std::uint32_t instance)
        : bvh_(bvh), rays_(rays), i_(i), instance_(instance)
    {
        inverse_ = rays.vector(PreparedRays::inverse_x, i);
        near_ = rays.vector(PreparedRays::near_x, i);
        far_ = rays.vector(PreparedRays::far_x, i);
        octant_ = rays.octant[i];
        for (int axis = 0; axis < 3; ++axis) near_side_[axis] = octant_ >> axis & 1 ? 3 + axis : axis;
        for (int k = 0; k < 3; ++k) axes_[k] = int(rays.axis[i] + std::uint32_t(k) + 1) % 3;
        origin_ = {Float(rays.f[PreparedRays::origin_x + axes_[0]][i]),
                   Float(rays.f[PreparedRays::origin_x + axes_[1]][i]),
                   Float(rays.f[PreparedRays::origin_x + axes_[2]][i])};
        shear_ = rays.vector(PreparedRays::shear_x, i);
    }

    /// Everything below a reference, with its box met already. True if it hit, where any hit will do.
    bool run(std::uint32_t root, SingleHit& hit)
    {
        BvhStack stack;
        int size = 0;
        std::uint32_t reference = root;
        for (;;) {
            if (BvhReference::is_node(reference)) {
                const BvhNode& node = bvh_.nodes[reference];
                const BoxDistances box = distances(node, Float(hit.t));
                size = any_hit ? push_any(stack, size, node, box)
                               : push_in_order(stack, size, node, node.order[octant_], box);
            } else if (BvhReference::is_triangles(reference)) {
                if (triangles(reference, hit) && any_hit) return true;
            } else if (others(reference, hit) && any_hit) {
                return true;
            }
            do {
                if (size == 0) return false;
                reference = stack.reference[--size];
            } while (!any_hit && stack.t[size] > hit.t);
            if (size > 0) prefetch(bvh_, stack.reference[size - 1]);
        }
    }

private:
    [[gnu::always_inline]] BoxDistances distances(const BvhNode& node, Float t_max) const
    {
        BoxDistances box;
        for (int part = 0; part < box_parts; ++part) {
            const auto plane = [&](int side) { return load(node.bounds[side] + part * lanes); };
            const Float near_x = fma(plane(near_side_[0]), inverse_.x, near_.x);
            const Float near_y = fma(plane(near_side_[1]), inverse_.y, near_.y);
            const Float near_z = fma(plane(near_side_[2]), inverse_.z, near_.z);
            const Float far_x = fma(plane((near_side_[0] + 3) % 6), inverse_.x, far_.x);
            const Float far_y = fma(plane((near_side_[1] + 3) % 6), inverse_.y, far_.y);
            const Float far_z = fma(plane((near_side_[2] + 3) % 6), inverse_.z, far_.z);
            box.near[part] = max(max(near_x, near_y), max(near_z, Float(0)));
            box.far[part] = min(min(far_x, far_y), min(far_z, t_max));
        }
        return box;
    }

    bool triangles(std::uint32_t reference, SingleHit& hit) const
    {
        const int n = BvhReference::triangle_count(reference);
        const std::size_t first = BvhReference::first_triangle(reference);
        const float* data = &bvh_.triangles[9 * first];
        const float* x = data + axes_[0] * n;
        const float* y = data + axes_[1] * n;
        const float* z = data + axes_[2] * n;
        bool found = false;
        for (int at = 0; at < n; at += lanes) {
            const auto corner = [&](int k) {
                return Vec3{load(x + 3 * k * n + at), load(y + 3 * k * n + at), load(z + 3 * k * n + at)} - origin_;
            };
            Float t, u, v;
            Mask m =
                meet_triangle(shear_.x, shear_.y, shear_.z, corner(0), corner(1), corner(2), Float(hit.t), t, u, v);
            m &= first_lanes(std::size_t(n - at));
            if (any_hit) m &= t < Float(hit.t);
            if (none(m)) continue;
            if (any_hit && !bvh_.has_alpha) return true;
            found |= take(m, t, u, v, [&](int lane) { return bvh_.keys[first + std::size_t(at + lane)]; }, hit);
            if (any_hit && found) return true;
        }
        return found;
    }

    /// The hits of some lanes, one by one.
    template <class Key>
    bool take(Mask m, Float t, Float u, Float v, const Key& key_of, SingleHit& hit) const
    {
        alignas(64) float ts[lanes], us[lanes], vs[lanes];
        store(ts, t), store(us, u), store(vs, v);
        bool found = false;
        for_each_active(m, [&](int lane) {
            const BvhKey key = key_of(lane);
            if (!hit.loses_to(ts[lane], key, instance_)) return;
            if (bvh_.has_alpha && !passes_alpha(bvh_, key, instance_, us[lane], vs[lane])) return;
            hit = {ts[lane], us[lane], vs[lane], key, instance_};
            found = true;
        });
        return found;
    }

    [[gnu::noinline]] bool others(std::uint32_t reference, SingleHit& hit) const
    {
        const std::uint32_t* indices = &bvh_.others[BvhReference::first_other(reference)];
        const BvhReference::Kind kind = BvhReference::other_kind(reference);
        if (kind == BvhReference::instance) return instance(indices[0], hit);
        const SceneTables& tables = *bvh_.tables;
        const Vec3 o = rays_.vector(PreparedRays::origin_x, i_), d = rays_.vector(PreparedRays::direction_x, i_);
        const int n = BvhReference::other_count(reference);
        bool found = false;
        for (int at = 0; at < n; at += lanes) {
            alignas(64) std::uint32_t index[bvh_width];
            for (int i = 0; i < lanes; ++i) index[i] = indices[std::min(at + i, n - 1)];
            const UInt which = load(index);
            Float t;
            Mask m;
            std::uint32_t base;
            if (kind == BvhReference::spheres) {
                const float* table = &tables.spheres[0].center.x;
                const UInt row = which * UInt(std::uint32_t(sizeof(SphereTable) / 4));
                const Vec3 center = fma(gather_vector(table + 3, row), Float(rays_.f[PreparedRays::time][i_]),
                                        gather_vector(table, row));
                m = meet_sphere(center, gather(table + 6, row), o, d, Float(hit.t), t);
                base = tables.first_sphere();
            } else {
                const float* table = &tables.disks[0].center.x;
                const UInt row = which * UInt(std::uint32_t(sizeof(DiskTable) / 4));
                m = meet_disk(gather_vector(table, row), gather_vector(table + 3, row), gather(table + 6, row), o, d,
                              Float(hit.t), t);
                base = tables.first_disk();
            }
            m &= first_lanes(std::size_t(n - at));
            if (any_hit) m &= t < Float(hit.t);
            found |= any(m) && take(m, t, Float(0), Float(0), [&](int lane) { return 2 * (base + index[lane]); }, hit);
        }
        return found;
    }

    static Vec3 gather_vector(const float* table, UInt row)
    {
        return {gather(table, row), gather(table + 1, row), gather(table + 2, row)};
    }

    bool instance(std::uint32_t index, SingleHit& hit) const
    {
        const InstanceTable& placed = bvh_.tables->instances[index];
        const BvhData::Mesh& mesh = bvh_.meshes[bvh_.mesh_of_instance[index]];
        const Vec3 o = transform_point(placed.object_from_render, rays_.vector(PreparedRays::origin_x, i_));
        const Vec3 d = transform_vector(placed.object_from_render, rays_.vector(PreparedRays::direction_x, i_));
        PreparedRays inner;
        inner.prepare(o, d, Float(hit.t), Float(rays_.f[PreparedRays::time][i_]), mesh.radius);
        const float before = hit.t;
        const std::uint32_t instance_before = hit.instance;
        const BvhKey key_before = hit.key;
        if (SingleTraversal(bvh_, inner, 0, index).run(mesh.root, hit)) return true;
        return hit.t != before || hit.key != key_before || hit.instance != instance_before;
    }

    const BvhData& bvh_;
    const PreparedRays& rays_;
    int i_;
    std::uint32_t instance_, octant_;
    Vec3 inverse_, near_, far_;
    Vec3 origin_, shear_;  ///< permuted for triangles
    int near_side_[3], axes_[3];
};

}  // namespace fathom::inline FATHOM_LANES
