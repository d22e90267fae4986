#pragma once
/// The tree as it lies in memory. Neither building it nor its layout knows of lanes; traversal is in traverse/stream.h
/// and traverse/packet.h.
#include <cstdint>
#include <vector>

#include "base/large_memory.h"
#include "geometry/bvh/bvh.h"
#include "geometry/records.h"

namespace fathom {

inline constexpr int bvh_width = 16;
/// So many parts of the tree can a ray leave for later at the bottom of its stack.
inline constexpr int bvh_deferred = 46;

/// What a child of a node is, in 32 bits.
///
///     000 moving:1 node:28           a node; a moving one takes two places in BvhData::nodes
///     kind:5 place:27                an instance, or a leaf of something other than triangles
///     011 place:29                   triangles that hold each vertex once, see IndexedLeaf
///     1 count-1:4 first:27           triangles
///
/// In this order, so that one comparison tells nodes, or leaves of triangles.
struct BvhReference {
    /// Only on stacks, `end`: the end of all that a ray has to do, or in one space. From 4 to 11.
    enum Kind : std::uint32_t { spheres = 4, disks, instance, curves, ribbons, points, end };
    static constexpr std::uint32_t triangle_bit = 1u << 31, indexed_bits = 3u << 29, node_end = 1u << 29,
                                   moving_bit = 1u << 28;
    static constexpr std::size_t max_triangles = std::size_t(1) << 27, max_others = std::size_t(1) << 27,
                                 max_indexed = std::size_t(1) << 29;
    static constexpr int kind_shift = 27;

    static std::uint32_t triangles(std::size_t first, std::size_t count)
    {
        return triangle_bit | std::uint32_t(count - 1) << 27 | std::uint32_t(first);
    }
    /// place: of an instance its number, else where in BvhData::others its leaf begins, in units of leaf_unit.
    static constexpr std::uint32_t others(Kind kind, std::size_t place)
    {
        return kind << kind_shift | std::uint32_t(place);
    }
    static std::uint32_t indexed_triangles(std::size_t place) { return indexed_bits | std::uint32_t(place); }

    static bool is_node(std::uint32_t r) { return r < node_end; }
    static bool is_moving(std::uint32_t node) { return node & moving_bit; }
    static std::uint32_t node(std::uint32_t r) { return r & (moving_bit - 1); }
    /// Of either kind.
    static bool is_triangle_leaf(std::uint32_t r) { return r >= indexed_bits; }
    static bool is_triangles(std::uint32_t r) { return r >= triangle_bit; }
    static bool is_indexed_triangles(std::uint32_t r) { return is_triangle_leaf(r) && !is_triangles(r); }
    static std::uint32_t indexed_place(std::uint32_t r) { return r & ~indexed_bits; }
    static int triangle_count(std::uint32_t r) { return int(r >> 27 & 15) + 1; }
    static std::uint32_t first_triangle(std::uint32_t r) { return r & 0x07ffffffu; }
    static Kind other_kind(std::uint32_t r) { return Kind(r >> kind_shift); }
    static std::uint32_t place(std::uint32_t r) { return r & 0x07ffffffu; }
};

/// A leaf in BvhData::others: how many primitives, their numbers (indices of spheres and disks, keys of triangles),
/// then what is tested.
struct BvhLeaf {
    static constexpr std::size_t unit = 4;
    static constexpr std::uint32_t moving_bit = 1u << 16;
    const std::uint32_t* words;

    int count() const { return int(words[0] & 255); }
    /// Whether it has data for each of the scene's vertex_times; told beside the count.
    bool moves() const { return words[0] & moving_bit; }
    const std::uint32_t* ids() const { return words + 1; }
    static std::size_t header(std::size_t n) { return 1 + n; }
    const float* data() const { return reinterpret_cast<const float*>(words + header(words[0] & 255)); }
};

/// One of triangles that holds each of their vertices once: by triangle, as bytes, which vertex is its first corner,
/// its second, its third; then x, y, z of the vertices, where they move for each of the scene's vertex_times. How many
/// those are stands beside the count.
struct IndexedLeaf : BvhLeaf {
    static constexpr int max_vertices = 16, vertices_shift = 8;

    static std::size_t corner_words(std::size_t n) { return (3 * n + 3) / 4; }
    std::ptrdiff_t vertices() const { return words[0] >> vertices_shift & 255; }
    const std::uint8_t* corners(int k) const { return reinterpret_cast<const std::uint8_t*>(data()) + k * count(); }
    const float* axis(std::ptrdiff_t i) const { return data() + corner_words(std::size_t(count())) + i * vertices(); }
};

/// One of pieces of curves. Arrays: where a piece begins along its segment, and how much of it that is; then, where any
/// moves for each of the scene's vertex_times, both ends with their radii, of ribbons also the tangents there. The
/// first radius of solid curves is negative, or -0, the second of fibres.
struct CurveLeaf {
    static constexpr int first_time = 2;
    static constexpr int arrays_at_time(bool ribbons) { return ribbons ? 14 : 8; }
};

/// Up to 16 children; the boxes of slots without a child are empty (low bound above high). Behind a node that moves
/// stands another, whose bounds are what the first one's change by until the shutter closes.
struct alignas(64) BvhNode {
    float bounds[6][bvh_width];      ///< low x, y, z, high x, y, z
    std::uint32_t child[bvh_width];  ///< any-hit rays take the last first: it stops most of them for the work it takes
    /// By octant (bit per axis, set where the direction is negative): the slots from far to near, 4 bits each, the
    /// first 8 in the low word.
    std::uint32_t order[8][2];
};
static_assert(sizeof(BvhNode) == 512);

/// A number per triangle of a leaf: the primitive's number times 2, plus 1 for the second half of a quad. Ties between
/// hits go to the lower one.
using BvhKey = std::uint32_t;

using BvhNodes = std::vector<BvhNode, UnsetAllocator<BvhNode>>;

struct BvhData {
    BvhNodes nodes;
    /// By leaf of n triangles: 9 arrays of n floats (x, y, z of a, b, c), one after the other. The whole is padded,
    /// since readers take 16 floats at once.
    LargeArray<float> triangles;
    LargeArray<BvhKey> keys;
    std::vector<std::uint32_t, LargeAllocator<std::uint32_t>> others;  ///< leaves, see BvhLeaf; padded

    std::uint32_t root = 0;  ///< a reference
    int stack_size = 0;      ///< that traversal can need
    float radius = 0;        ///< the largest coordinate of anything in the world
    bool empty = true;
    bool moving = false;  ///< something does while the shutter is open
    bool far = false;     ///< it is larger than caches: what rays come to next is to be fetched ahead
    /// What instances place, by shape.
    struct Mesh {
        std::uint32_t root = 0;
        float radius = 0;
        bool empty = true;
    };
    std::vector<Mesh> meshes;  ///< as many as shapes, or none

    IndexedLeaf indexed_leaf(std::uint32_t reference) const
    {
        return {{&others[std::size_t(BvhReference::indexed_place(reference)) * BvhLeaf::unit]}};
    }

    /// Of a leaf of triangles, of either kind.
    int triangle_count(std::uint32_t leaf) const
    {
        return BvhReference::is_triangles(leaf) ? BvhReference::triangle_count(leaf) : indexed_leaf(leaf).count();
    }

    const GeometryTables* tables = nullptr;
    AlphaTest alpha_test = nullptr;
    const void* alpha_context = nullptr;
    bool has_alpha = false;  ///< some shape is alpha-tested, and there is a test
    BvhStatistics statistics;
};

/// Rounding of a ray's distance to a box and to what is in it, as a displacement in space, is at most this times the
/// sum of the largest coordinates of the ray's origin and of the tree. See traverse/ray.h for why.
inline constexpr float bvh_slack = 0x1p-19f;

/// The three corners of what a key names: of a triangle, or of one half of a quad. time: which of vertex_times.
void vertices_of(const GeometryTables& tables, BvhKey key, Vec3f out[3], std::size_t time = 0);

}  // namespace fathom
