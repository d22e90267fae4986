#pragma once
/// The acceleration structure for scenes of more than a few dozen primitives: a tree of nodes with 16 children over
/// triangles, quads, spheres, disks and instances of meshes.
///
/// Plain arrays cross this interface, so that bvh*.cpp may be compiled with another number of lanes than its callers.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "fathom/tree_build.h"

namespace fathom {

struct GeometryTables;

/// Rays as arrays: points o + t d, 0 < t < t_max, d of unit length. Each array is readable for 32 elements past
/// `count`.
struct RayArrays {
    const float *ox, *oy, *oz, *dx, *dy, *dz;
    const float* t_max;  ///< null: infinity
    const float* time;   ///< null: 0
    std::size_t count;
};

/// The nearest hit of each ray. Elements past the rays' count are not written.
///
/// t is the ray's t_max where nothing is hit; u, v are the weights of a triangle's second and third vertex, or how far
/// along edge_u and edge_v of a quad the hit lies, and not set for other kinds; `primitive` is no_index without a hit,
/// `instance` is no_index where the primitive stands in the world itself.
struct HitArraysOut {
    float *t, *u, *v;
    std::uint32_t *primitive, *instance;
};

/// A hit on a shape with ShapeRecord::alpha_tested: the ray as it was given, and the rest as in HitArraysOut; u = v = 0
/// for spheres and disks.
struct AlphaCandidate {
    float origin[3], direction[3];
    float t, u, v;
    std::uint32_t primitive, instance;
};
/// Whether such a hit counts. Must answer alike whenever it is asked the same; may be asked for hits that turn out not
/// to be the nearest.
using AlphaTest = bool (*)(const void* context, const AlphaCandidate& candidate);

struct BvhStatistics {
    std::size_t nodes = 0, children = 0;          ///< nodes of 16, and how many of their children are in use
    std::size_t leaves = 0, leaf_primitives = 0;  ///< a quad counts twice, as two triangles
    std::size_t bytes = 0;                        ///< of all that rendering needs
    std::size_t peak_bytes = 0;                   ///< while building, the result included
    double cost = 0;                              ///< expected steps of a random ray that meets the scene
    double diagonal = 0;                          ///< of the box around everything
    double build_s = 0;
};

/// What rays went through, summed: a node or leaf that several rays visit together counts once for each of them.
struct BvhVisits {
    std::uint64_t nodes = 0, primitives = 0;
};

/// The nearest hit is the least of (t, primitive, instance): the same bits for any instruction set, order of rays,
/// `coherent` or not. Queries may run on many threads at once.
class Bvh {
public:
    Bvh();
    ~Bvh();
    Bvh(Bvh&&) noexcept;
    Bvh& operator=(Bvh&&) noexcept;

    /// Builds on all threads; the same tree for any number of them. Triangles with a coordinate that is not finite, or
    /// with two equal vertices, are never hit. Keeps a pointer to the tables, whose spheres, disks, shapes and
    /// instances are read while tracing. Throws std::length_error beyond 2^27 triangles.
    void build(const GeometryTables& tables, TreeBuild level = TreeBuild::standard);

    /// After instances that are not still, poses, shapes' flags or the vertices of `changed` shapes, which only
    /// instances place, have changed in the tables: builds what they make necessary. The tree must have been built of
    /// tables that are `editable`, or only flags may have changed.
    void update(const std::vector<std::uint32_t>& changed);

    /// Takes some shadow rays for what others will be like: those that ask for any hit first go to what stops most of
    /// these. Changes no result. Does nothing where something moves, or may be moved later.
    void expect(const RayArrays& shadow_rays);

    /// For hits on shapes with ShapeRecord::alpha_tested; null: all are opaque.
    void set_alpha_test(AlphaTest test, const void* context);

    /// `coherent` promises nothing: neighbours among the rays are worth tracing together.
    /// visits  added to, if given
    void closest(const RayArrays& rays, const HitArraysOut& hits, bool coherent, BvhVisits* visits = nullptr) const;

    /// blocked[i] is 1 where ray i hits anything, else 0.
    void occluded(const RayArrays& rays, std::uint32_t* blocked, bool coherent, BvhVisits* visits = nullptr) const;

    std::size_t memory_bytes() const { return statistics().bytes; }
    const BvhStatistics& statistics() const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

}  // namespace fathom
