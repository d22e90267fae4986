// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Memory layout of the BVH. Construction and layout do not depend on the number of lanes; traversal/stream.h and
/// traversal/packet.h traverse it.
#include <cstdint>
#include <vector>

#include "base/large_memory.h"
#include "geometry/bvh/bvh.h"
#include "geometry/records.h"

namespace fathom {

inline constexpr int bvh_width = 16;
/// Number of deferred subtrees that fit at the bottom of a ray's stack.
inline constexpr int bvh_deferred = 46;

/// Reference to a child of a node, 32 bits, most significant first:
///
///     000 moving:1 node:28       a node; a moving one takes two slots of BvhData::nodes
///     kind:5 place:27            an instance, or a leaf of primitives other than triangles
///     011 place:29               an indexed leaf of triangles, see IndexedLeaf
///     1 count-1:4 first:27       a leaf of triangles
///
/// The ranges of references ascend in this order, so that one comparison identifies nodes or leaves of triangles.
struct BvhReference {
    /// Kinds of references to other things than nodes and triangles, from 4 to 11. `end` occurs only on stacks: it ends
    /// a ray's work in the world or in an instance.
    enum Kind : std::uint32_t { spheres = 4, disks, instance, curves, ribbons, points, end };
    static constexpr std::uint32_t triangle_bit = 1u << 31, indexed_bits = 3u << 29, node_end = 1u << 29,
                                   moving_bit = 1u << 28;
    static constexpr std::size_t max_triangles = std::size_t(1) << 27, max_others = std::size_t(1) << 27,
                                 max_indexed = std::size_t(1) << 29;
    static constexpr int kind_shift = 27;

    /// first: index of the leaf's first triangle in BvhData::keys. count: 1 to 16.
    static std::uint32_t triangles(std::size_t first, std::size_t count)
    {
        return triangle_bit | std::uint32_t(count - 1) << 27 | std::uint32_t(first);
    }
    /// place: the index of an instance, or the offset of a leaf in BvhData::others, in units of BvhLeaf::unit.
    static constexpr std::uint32_t others(Kind kind, std::size_t place)
    {
        return kind << kind_shift | std::uint32_t(place);
    }
    static std::uint32_t indexed_triangles(std::size_t place) { return indexed_bits | std::uint32_t(place); }

    static bool is_node(std::uint32_t r) { return r < node_end; }
    static bool is_moving(std::uint32_t node) { return node & moving_bit; }
    static std::uint32_t node(std::uint32_t r) { return r & (moving_bit - 1); }
    /// Returns whether a reference is to a leaf of triangles, indexed or not.
    static bool is_triangle_leaf(std::uint32_t r) { return r >= indexed_bits; }
    static bool is_triangles(std::uint32_t r) { return r >= triangle_bit; }
    static bool is_indexed_triangles(std::uint32_t r) { return is_triangle_leaf(r) && !is_triangles(r); }
    static std::uint32_t indexed_place(std::uint32_t r) { return r & ~indexed_bits; }
    static int triangle_count(std::uint32_t r) { return int(r >> 27 & 15) + 1; }
    static std::uint32_t first_triangle(std::uint32_t r) { return r & 0x07ffffffu; }
    static Kind other_kind(std::uint32_t r) { return Kind(r >> kind_shift); }
    static std::uint32_t place(std::uint32_t r) { return r & 0x07ffffffu; }
};

/// A leaf in BvhData::others: the number of primitives, their ids (indices of spheres and disks, keys of triangles),
/// then the data of the intersection test.
struct BvhLeaf {
    static constexpr std::size_t unit = 4;
    static constexpr std::uint32_t moving_bit = 1u << 16;
    const std::uint32_t* words;

    int count() const { return int(words[0] & 255); }
    /// Whether the leaf has data for each of the scene's vertex_times; stored beside the count.
    bool moves() const { return words[0] & moving_bit; }
    const std::uint32_t* ids() const { return words + 1; }
    static std::size_t header(std::size_t n) { return 1 + n; }
    const float* data() const { return reinterpret_cast<const float*>(words + header(words[0] & 255)); }
};

/// Indexed leaf of triangles, which stores each vertex once. For each of the three corners, one byte per triangle gives
/// the vertex; x, y and z of the vertices follow, for each of vertex_times if they move. The number of vertices is
/// stored beside the count.
struct IndexedLeaf : BvhLeaf {
    static constexpr int max_vertices = 16, vertices_shift = 8;

    static std::size_t corner_words(std::size_t n) { return (3 * n + 3) / 4; }
    std::ptrdiff_t vertices() const { return words[0] >> vertices_shift & 255; }
    const std::uint8_t* corners(int k) const { return reinterpret_cast<const std::uint8_t*>(data()) + k * count(); }
    const float* axis(std::ptrdiff_t i) const { return data() + corner_words(std::size_t(count())) + i * vertices(); }
};

/// Leaf of curve pieces. Arrays: where a piece begins on its segment, and the fraction of the segment that it covers;
/// then, for each of vertex_times if any piece moves, both ends with radii, and for ribbons the tangents there. The
/// first radius is negative (or -0) for solid curves, the second for fibers.
struct CurveLeaf {
    static constexpr int first_time = 2;
    static constexpr int arrays_at_time(bool ribbons) { return ribbons ? 14 : 8; }
};

/// Wide node with up to 16 children; boxes of unused slots are empty (low bound above high). A moving node is followed
/// by another whose bounds are the change of its bounds over the shutter interval.
struct alignas(64) BvhNode {
    float bounds[6][bvh_width];      ///< rows: low x, y, z, high x, y, z
    std::uint32_t child[bvh_width];  ///< references; occlusion rays visit the last child first, since it blocks most
                                     ///< rays per cost
    /// Slots from far to near for each octant (a bit per axis, set if the direction is negative): 4 bits each, the
    /// first 8 in the low word.
    std::uint32_t order[8][2];
};
static_assert(sizeof(BvhNode) == 512);

/// Key of a triangle in a leaf: twice the primitive's index, plus 1 for the second half of a quad. Ties between hits go
/// to the lower key.
using BvhKey = std::uint32_t;

using BvhNodes = std::vector<BvhNode, UnsetAllocator<BvhNode>>;

/// The arrays of a BVH.
struct BvhData {
    BvhNodes nodes;
    /// Vertices of leaves: 9 arrays of n floats (x, y, z of the vertices a, b, c) for each leaf of n triangles. The end
    /// is padded, since vector loads read 16 floats.
    LargeArray<float> triangles;
    LargeArray<BvhKey> keys;
    std::vector<std::uint32_t, LargeAllocator<std::uint32_t>> others;  ///< leaves, see BvhLeaf; padded

    std::uint32_t root = 0;  ///< a BvhReference
    int stack_size = 0;      ///< maximum number of stack entries that traversal needs
    float radius = 0;        ///< largest absolute coordinate in the world
    bool empty = true;
    bool moving = false;  ///< whether anything moves during the shutter interval
    bool far = false;     ///< whether the tree is larger than the caches, so that traversal prefetches
    /// The BVH of a shape used by instances.
    struct Mesh {
        std::uint32_t root = 0;
        float radius = 0;
        bool empty = true;
    };
    std::vector<Mesh> meshes;  ///< indexed by shape; empty if there are no instances

    IndexedLeaf indexed_leaf(std::uint32_t reference) const
    {
        return {{&others[std::size_t(BvhReference::indexed_place(reference)) * BvhLeaf::unit]}};
    }

    /// Number of triangles in a leaf of either layout.
    int triangle_count(std::uint32_t leaf) const
    {
        return BvhReference::is_triangles(leaf) ? BvhReference::triangle_count(leaf) : indexed_leaf(leaf).count();
    }

    const GeometryTables* tables = nullptr;
    AlphaTest alpha_test = nullptr;
    const void* alpha_context = nullptr;
    bool has_alpha = false;  ///< whether a shape is alpha-tested and there is an alpha test
    BvhStatistics statistics;
};

/// Bound on the rounding errors of a ray's distances to a box and its contents, as a displacement in space: this times
/// the sum of the largest coordinates of the ray's origin and of the tree. Derived in traversal/ray.h.
inline constexpr float bvh_slack = 0x1p-19f;

/// Returns the three vertices of the triangle, or half of a quad, with this key. time: index of vertex_times.
void vertices_of(const GeometryTables& tables, BvhKey key, Vec3f out[3], std::size_t time = 0);

}  // namespace fathom
