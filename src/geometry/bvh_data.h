#pragma once
/// The tree as it lies in memory. Neither building it nor its layout knows of lanes; traversal is in bvh_single.h and
/// bvh_packet.h.
#include <cstdint>
#include <vector>

#include "geometry/bvh.h"
#include "geometry/bvh_memory.h"
#include "integrate/tables.h"

namespace fathom {

inline constexpr int bvh_width = 16;
/// So many parts of the tree can a ray leave for later at the bottom of its stack.
inline constexpr int bvh_deferred = 46;

/// What a child of a node is, in 32 bits.
///
///     00 node:30                     a node
///     01 kind:2 count-1:4 first:24   spheres, disks or one instance
///     1  count-1:4 first:27          triangles
struct BvhReference {
    /// Only on stacks, `end`: the end of all that a ray has to do, or in one space.
    enum Kind : std::uint32_t { spheres, disks, instance, end };
    static constexpr std::uint32_t triangle_bit = 1u << 31, other_bit = 1u << 30;
    static constexpr std::size_t max_triangles = std::size_t(1) << 27, max_others = std::size_t(1) << 24;

    static std::uint32_t triangles(std::size_t first, std::size_t count)
    {
        return triangle_bit | std::uint32_t(count - 1) << 27 | std::uint32_t(first);
    }
    static std::uint32_t others(Kind kind, std::size_t first, std::size_t count)
    {
        return other_bit | kind << 28 | std::uint32_t(count - 1) << 24 | std::uint32_t(first);
    }
    static bool is_node(std::uint32_t r) { return r < other_bit; }
    static bool is_triangles(std::uint32_t r) { return r >= triangle_bit; }
    static int triangle_count(std::uint32_t r) { return int(r >> 27 & 15) + 1; }
    static std::uint32_t first_triangle(std::uint32_t r) { return r & 0x07ffffffu; }
    static Kind other_kind(std::uint32_t r) { return Kind(r >> 28 & 3); }
    static int other_count(std::uint32_t r) { return int(r >> 24 & 15) + 1; }
    static std::uint32_t first_other(std::uint32_t r) { return r & 0x00ffffffu; }
};

/// Up to 16 children; the boxes of slots without a child are empty (low bound above high).
struct alignas(64) BvhNode {
    float bounds[6][bvh_width];  ///< low x, y, z, high x, y, z
    std::uint32_t child[bvh_width];
    /// By octant (bit per axis, set where the direction is negative): the slots from far to near, 4 bits each, the
    /// first 8 in the low word.
    std::uint32_t order[8][2];
};
static_assert(sizeof(BvhNode) == 512);

/// A number per triangle of a leaf: the primitive's number times 2, plus 1 for the second half of a quad. Ties between
/// hits go to the lower one.
using BvhKey = std::uint32_t;

struct BvhData {
    LargeArray<BvhNode> nodes;
    /// By leaf of n triangles: 9 arrays of n floats (x, y, z of a, b, c), one after the other. The whole is padded,
    /// since readers take 16 floats at once.
    LargeArray<float> triangles;
    LargeArray<BvhKey> keys;
    std::vector<std::uint32_t> others;  ///< indices of spheres, of disks, of instances, leaf by leaf

    std::uint32_t root = 0;  ///< a reference
    int stack_size = 0;      ///< that traversal can need
    float radius = 0;        ///< the largest coordinate of anything in the world
    bool empty = true;
    struct Mesh {
        std::uint32_t root = 0;
        float radius = 0;
        bool empty = true;
    };
    std::vector<Mesh> meshes;
    std::vector<std::uint32_t> mesh_of_instance;

    const SceneTables* tables = nullptr;
    AlphaTest alpha_test = nullptr;
    const void* alpha_context = nullptr;
    bool any_alpha_shape = false;
    bool has_alpha = false;  ///< some shape is alpha-tested, and there is a test
    BvhStatistics statistics;
};

/// Rounding of a ray's distance to a box and to what is in it, as a displacement in space, is at most this times the
/// sum of the largest coordinates of the ray's origin and of the tree. See bvh_ray.h for why.
inline constexpr float bvh_slack = 0x1p-19f;

/// The three corners of what a key names: of a triangle, or of one half of a quad.
void vertices_of(const SceneTables& tables, BvhKey key, Vec3f out[3]);

void build_bvh(const SceneTables& tables, BvhData& bvh);

}  // namespace fathom
