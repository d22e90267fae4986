// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Bounding volume hierarchy (BVH) with 16 children per node over triangles, quads, spheres, disks, curves, points and
/// instances of meshes, for scenes of more than a few dozen primitives.
///
/// Only plain arrays cross this interface, so that the BVH may be compiled with another number of lanes than its
/// callers.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "fathom/bvh_quality.h"

namespace fathom {

struct GeometryTables;

/// A candidate hit on a shape with ShapeRecord::alpha_tested, with the ray in world space. Other members are as in
/// HitArraysOut; u = v = 0 for spheres and disks.
struct AlphaCandidate {
    float origin[3], direction[3];
    float t, u, v;
    std::uint32_t primitive, instance;
};
/// Whether a candidate hit counts. The result must depend on the arguments alone; candidates may turn out not to be
/// nearest hits.
using AlphaTest = bool (*)(const void* context, const AlphaCandidate& candidate);

/// Rays as arrays: points o + t d with 0 < t < t_max and d of unit length. Each array must be readable for 32 elements
/// past `count`.
struct RayArrays {
    const float *ox, *oy, *oz, *dx, *dy, *dz;
    const float* t_max;  ///< null: unlimited
    const float* time;   ///< null: all rays have time 0
    std::size_t count;
    AlphaTest alpha_test = nullptr;  ///< replaces the test of set_alpha_test() for these rays, if there is one
};

/// The nearest hit of each ray; elements past the count are not written.
///
/// t is the ray's t_max if nothing is hit. u and v are the barycentric weights of a triangle's second and third vertex,
/// or the position along edge_u and edge_v of a quad; they are not set for other primitives. `primitive` is no_index
/// without a hit; `instance` is no_index if the primitive is not instanced.
struct HitArraysOut {
    float *t, *u, *v;
    std::uint32_t *primitive, *instance;
};

/// Size and quality of a BVH.
struct BvhStatistics {
    std::size_t nodes = 0, children = 0;          ///< wide nodes, and how many of their children are in use
    std::size_t leaves = 0, leaf_primitives = 0;  ///< a quad counts as two triangles
    std::size_t bytes = 0;                        ///< memory for rendering
    std::size_t peak_bytes = 0;                   ///< peak memory of construction, result included
    double cost = 0;                              ///< expected cost of a random ray that hits the scene's box
    double diagonal = 0;                          ///< diagonal of the scene's box
    double build_s = 0;
};

/// Visits summed over rays: a node or leaf that several rays visit together counts once for each.
struct BvhVisits {
    std::uint64_t nodes = 0, primitives = 0;
};

/// The nearest hit is the minimum of (t, primitive, instance), bitwise equal for all instruction sets, orders of rays
/// and values of `coherent`. Queries are thread-safe.
class Bvh {
public:
    Bvh();
    ~Bvh();
    Bvh(Bvh&&) noexcept;
    Bvh& operator=(Bvh&&) noexcept;

    /// Builds the BVH with all threads; the result does not depend on their number. Triangles with non-finite
    /// coordinates or two equal vertices are never hit. Keeps a pointer to the tables, which tracing reads. Throws
    /// std::length_error beyond 2^27 triangles.
    void build(const GeometryTables& tables, BvhQuality level = BvhQuality::standard);

    /// Updates the BVH after changes of movable instances, poses, shape flags, or the vertices of the `changed` shapes,
    /// which must be shapes used by instances only. The tables must be `editable` unless only flags changed.
    void update(const std::vector<std::uint32_t>& changed);

    /// Orders the children of nodes for occlusion rays similar to these. Results do not change. Without effect if
    /// something moves or may be edited.
    void expect(const RayArrays& shadow_rays);

    /// Calls visit(low, high, is_divisible) for boxes that together contain everything, from the root's children down.
    /// The boxes inside a divisible one follow if it returns true. Returns false without a call if something moves or
    /// the BVH has no boxes.
    using VisitBox = std::function<bool(const float (&low)[3], const float (&high)[3], bool is_divisible)>;
    bool visit_boxes(const VisitBox& visit) const;

    /// Sets the test for hits on shapes with ShapeRecord::alpha_tested; null: all are opaque.
    void set_alpha_test(AlphaTest test, const void* context);

    /// Finds the nearest hits. coherent: a hint that adjacent rays are worth tracing together. visits: incremented if
    /// not null.
    void closest(const RayArrays& rays, const HitArraysOut& hits, bool coherent, BvhVisits* visits = nullptr) const;

    /// Sets blocked[i] to 1 if ray i hits anything, else to 0. Other arguments are as in closest().
    void occluded(const RayArrays& rays, std::uint32_t* blocked, bool coherent, BvhVisits* visits = nullptr) const;

    /// Largest absolute coordinate in the world.
    float radius() const;
    std::size_t memory_bytes() const { return statistics().bytes; }
    const BvhStatistics& statistics() const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace fathom
