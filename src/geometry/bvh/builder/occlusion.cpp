// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/occlusion.h"

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>
#include <utility>

#include "fathom/vector.h"

namespace fathom::bvh {

namespace {

bool is_used(const BvhNode& node, int slot)
{
    return node.bounds[0][slot] <= node.bounds[3][slot];
}

/// Statistics of the trial rays that enter a child's box.
struct Tried {
    float stops = 0, work = 0;
};
using TriedChildren = std::array<Tried, bvh_width>;

struct TriedRay {
    Vec3d o, d, inverse;
    double t_max;
};

/// Result of a trial ray in a subtree.
struct Outcome {
    float stopped;  ///< probability that the ray is blocked
    float work;     ///< cost of visiting all nodes and leaves that the ray passes through
};

/// Traces trial rays through all nodes and leaves that they pass, without stopping at hits.
class Trial {
public:
    explicit Trial(const BvhData& tree) : tree_(tree) {}

    void send(const TriedRay& ray) { visit(tree_.root, ray); }
    const std::unordered_map<std::uint32_t, TriedChildren>& nodes() const { return nodes_; }

private:
    static constexpr float node_work = 1, leaf_work = 2;
    /// Estimate for leaves of other primitives and instances, which are not visited.
    static constexpr Outcome unknown{0.5f, 6};

    Outcome visit(std::uint32_t reference, const TriedRay& ray)
    {
        if (BvhReference::is_node(reference)) return visit_node(reference, ray);
        if (!BvhReference::is_triangles(reference)) return unknown;
        return {is_stopped(reference, ray) ? 1.f : 0.f, leaf_work};
    }

    Outcome visit_node(std::uint32_t number, const TriedRay& ray)
    {
        const BvhNode& node = tree_.nodes[number];
        Outcome all{0, node_work};
        TriedChildren& children = nodes_[number];
        for (int i = 0; i < bvh_width; ++i) {
            if (!is_used(node, i) || !passes(node, i, ray)) continue;
            const Outcome there = visit(node.child[i], ray);
            Tried& tried = children[std::size_t(i)];
            tried.stops += there.stopped;
            // A blocked ray visits about half of the subtree before the hit.
            tried.work += std::max(node_work, there.work * (1 - there.stopped / 2));
            all.stopped += (1 - all.stopped) * there.stopped;
            all.work += there.work;
        }
        return all;
    }

    static bool passes(const BvhNode& node, int slot, const TriedRay& ray)
    {
        double near = 0, far = ray.t_max;
        const auto cut = [&](int axis, double o, double inverse) {
            const double a = (node.bounds[axis][slot] - o) * inverse, b = (node.bounds[3 + axis][slot] - o) * inverse;
            near = std::max(near, std::min(a, b)), far = std::min(far, std::max(a, b));
        };
        cut(0, ray.o.x, ray.inverse.x), cut(1, ray.o.y, ray.inverse.y), cut(2, ray.o.z, ray.inverse.z);
        return near <= far;
    }

    /// Moeller and Trumbore 1997; it is not watertight, which does not matter for statistics.
    bool is_stopped(std::uint32_t leaf, const TriedRay& ray) const
    {
        const std::size_t n = std::size_t(BvhReference::triangle_count(leaf));
        const float* const data = &tree_.triangles[9 * std::size_t(BvhReference::first_triangle(leaf))];
        for (std::size_t i = 0; i < n; ++i) {
            const auto corner = [&](std::size_t k) {
                const float* const p = data + 3 * k * n + i;
                return Vec3d{p[0], p[n], p[2 * n]};
            };
            const Vec3d a = corner(0), u = corner(1) - a, v = corner(2) - a, from = ray.o - a;
            const Vec3d p = cross(ray.d, v), q = cross(from, u);
            const double scale = 1 / dot(u, p), along_u = dot(from, p) * scale, along_v = dot(ray.d, q) * scale,
                         t = dot(v, q) * scale;
            if (along_u >= 0 && along_v >= 0 && along_u + along_v <= 1 && t > 0 && t < ray.t_max) return true;
        }
        return false;
    }

    const BvhData& tree_;
    std::unordered_map<std::uint32_t, TriedChildren> nodes_;
};

/// Assigns slots by blocked rays per cost, the best child last.
void order_children(BvhNode& node, const TriedChildren& tried)
{
    const BvhNode old = node;
    std::array<std::uint32_t, bvh_width> from, to{};
    std::array<float, bvh_width> gain;
    for (std::uint32_t i = 0; i < bvh_width; ++i) {
        from[i] = i;
        // Children that few rays entered keep roughly their former position.
        constexpr float former = 0.05f;
        gain[i] = is_used(old, int(i)) ? (tried[i].stops + former * float(i + 1) / bvh_width) / (tried[i].work + 1)
                                       : std::numeric_limits<float>::infinity();
    }
    std::sort(from.begin(), from.end(),
              [&](std::uint32_t a, std::uint32_t b) { return gain[a] != gain[b] ? gain[a] < gain[b] : a < b; });
    for (std::uint32_t i = 0; i < bvh_width; ++i) {
        to[from[i]] = i;
        node.child[i] = old.child[from[i]];
        for (int side = 0; side < 6; ++side) node.bounds[side][i] = old.bounds[side][from[i]];
    }
    for (auto& order : node.order)
        for (std::uint32_t& word : order) {
            const std::uint32_t former = std::exchange(word, 0);
            for (int k = 0; k < 32; k += 4) word |= to[former >> k & 15] << k;
        }
}

}  // namespace

void order_by_occlusion(BvhData& tree, const RayArrays& rays)
{
    Trial trial(tree);
    for (std::size_t i = 0; i < rays.count; ++i) {
        const Vec3d d{rays.dx[i], rays.dy[i], rays.dz[i]};
        trial.send({{rays.ox[i], rays.oy[i], rays.oz[i]},
                    d,
                    {1 / d.x, 1 / d.y, 1 / d.z},
                    rays.t_max ? rays.t_max[i] : std::numeric_limits<float>::infinity()});
    }
    for (const auto& [number, tried] : trial.nodes()) order_children(tree.nodes[number], tried);
}

}  // namespace fathom::bvh
