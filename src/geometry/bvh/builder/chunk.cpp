// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/chunk.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/bvh/builder/leaf_data.h"

namespace fathom::bvh {

namespace {

/// Lists the binary nodes that represent node i if it may become up to j children of a wide node.
void collect(const BinaryTree& tree, std::uint32_t i, int j, std::uint32_t* out, int& count)
{
    const BinaryNode& node = tree.nodes[i];
    const int k = j == 1 || node.leaf ? 0 : node.choices[j - 1];
    if (k == 0) {
        out[count++] = i;
        return;
    }
    collect(tree, node.left, k, out, count);
    collect(tree, node.right, j - k, out, count);
}

class ChunkWriter {
public:
    ChunkWriter(Chunk& chunk, const GeometryTables& tables, const BinaryTree& tree, BvhData& bvh)
        : chunk_(chunk), tables_(tables), tree_(tree), bvh_(bvh), next_triangle_(chunk.first_triangle)
    {
    }

    void run()
    {
        // Indexed leaves save at least a quarter, which bounds their size; growing the vector would leave holes in
        // memory.
        if (chunk_.compact) chunk_.others.reserve(chunk_.triangles * plain_words * 3 / 4);
        chunk_.root = emit(tree_.nodes[chunk_.from], 0);
        chunk_.triangles = next_triangle_ - chunk_.first_triangle;
    }

private:
    /// Writes the subtree of a binary node. depth: depth of the node below the chunk's root.
    Subtree emit(const BinaryNode& node, int depth)
    {
        if (becomes_leaf(node)) return emit_leaf(node);
        const std::uint32_t self = std::uint32_t(chunk_.nodes.size());
        chunk_.nodes.emplace_back();
        std::uint32_t children[bvh_width];
        const int count = collect_children(tree_, node, children);
        chunk_.children += std::size_t(count);
        chunk_.depth = std::max(chunk_.depth, depth + 1);
        Box boxes[bvh_width];
        for (int i = 0; i < count; ++i) boxes[i] = tree_.nodes[children[i]].box();
        Subtree subtrees[bvh_width];
        // The leaves of a node are stored next to each other.
        for (int i = 0; i < count; ++i)
            if (becomes_leaf(tree_.nodes[children[i]])) subtrees[i] = emit_leaf(tree_.nodes[children[i]]);
        for (int i = 0; i < count; ++i)
            if (!becomes_leaf(tree_.nodes[children[i]])) subtrees[i] = emit(tree_.nodes[children[i]], depth + 1);
        Subtree all = finish_node(chunk_.nodes[self], boxes, subtrees, count);
        all.reference = self;
        return all;
    }

    Subtree emit_leaf(const BinaryNode& node)
    {
        ++chunk_.leaves;
        std::uint32_t ids[bvh_width];
        const int n = gather_ids(tree_, node, ids);
        const float cost = leaf_cost(node.kinds, std::size_t(n));
        if (node.kinds == Item::triangle) {
            float area = 0;
            const std::uint32_t reference = emit_triangles(ids, n, area);
            // A random ray through the box hits a triangle of area a with probability a / half_area, wherever the
            // triangle lies.
            const float half_area = std::max(node.box().half_area(), std::numeric_limits<float>::min());
            return {reference, 1 - std::exp(-area / half_area), cost};
        }
        constexpr float unknown = 0.5f;
        if (node.kinds == Item::instance) return {BvhReference::others(BvhReference::instance, ids[0]), unknown, cost};
        const std::size_t place = put_leaf(tables_, node.kinds, ids, std::size_t(n), chunk_.others) / BvhLeaf::unit;
        return {node.kinds == Item::moving_triangle ? BvhReference::indexed_triangles(place)
                                                    : BvhReference::others(reference_kind(node.kinds), place),
                unknown, cost};
    }

    static BvhReference::Kind reference_kind(std::uint32_t item_kind)
    {
        switch (item_kind) {
            case Item::sphere:
                return BvhReference::spheres;
            case Item::disk:
                return BvhReference::disks;
            case Item::curve:
                return BvhReference::curves;
            case Item::ribbon:
                return BvhReference::ribbons;
            default:
                return BvhReference::points;
        }
    }

    /// Writes vertices in the layout of BvhData::triangles.
    void put_vertices(const std::uint32_t* ids, std::size_t n, float* out) const
    {
        for (std::size_t i = 0; i < n; ++i) {
            Vec3f vertices[3];
            vertices_of(tables_, ids[i], vertices);
            for (std::size_t v = 0; v < 3; ++v) {
                out[(3 * v + 0) * n + i] = vertices[v].x;
                out[(3 * v + 1) * n + i] = vertices[v].y;
                out[(3 * v + 2) * n + i] = vertices[v].z;
            }
        }
    }

    /// Sum of triangle areas, in double precision: squared areas of small triangles underflow in float.
    static float area_of(const float* vertices, std::size_t n)
    {
        double areas[bvh_width];
        for (std::size_t i = 0; i < n; ++i) {
            const auto edge = [&](std::size_t to, std::size_t axis) {
                return double(vertices[(3 * to + axis) * n + i]) - double(vertices[axis * n + i]);
            };
            const double ax = edge(1, 0), ay = edge(1, 1), az = edge(1, 2);
            const double bx = edge(2, 0), by = edge(2, 1), bz = edge(2, 2);
            const double x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
            areas[i] = std::sqrt(x * x + y * y + z * z);
        }
        return float(0.5 * std::accumulate(areas, areas + n, 0.0));
    }

    /// Writes a leaf of triangles. area: receives the sum of their areas.
    std::uint32_t emit_triangles(std::uint32_t* ids, int count, float& area)
    {
        std::sort(ids, ids + count);
        // Pieces of one triangle from spatial splits may meet in a leaf again.
        const std::size_t n = std::size_t(std::unique(ids, ids + count) - ids);
        std::uint32_t indexed = 0;
        if (chunk_.compact && emit_indexed(ids, n, indexed, area)) return indexed;
        const std::size_t first = next_triangle_;
        next_triangle_ += n;
        float* out = &bvh_.triangles[9 * first];
        BvhKey* keys = &bvh_.keys[first];
        if (chunk_.compact) {
            const std::size_t before = chunk_.keys_apart.size();
            chunk_.triangles_apart.resize(9 * (before + n));
            chunk_.keys_apart.resize(before + n);
            out = &chunk_.triangles_apart[9 * before];
            keys = &chunk_.keys_apart[before];
        }
        put_vertices(ids, n, out);
        std::copy_n(ids, n, keys);
        area = area_of(out, n);
        return BvhReference::triangles(first, n);
    }

    /// Writes an indexed leaf, which stores each vertex once, if it is smaller by at least a quarter, as in connected
    /// meshes; otherwise returns false. Smaller savings do not pay: rays that visit both kinds of leaves take longer.
    bool emit_indexed(const std::uint32_t* ids, std::size_t n, std::uint32_t& reference, float& area)
    {
        IndexedTriangles triangles(tables_, false);
        for (std::size_t i = 0; i < n; ++i)
            if (!triangles.add(ids[i])) return false;
        if (4 * triangles.words() > 3 * plain_words * n) return false;
        float vertices[9 * bvh_width];
        put_vertices(ids, n, vertices);
        area = area_of(vertices, n);
        reference = BvhReference::indexed_triangles(triangles.put(chunk_.others) / BvhLeaf::unit);
        return true;
    }

    static constexpr std::size_t plain_words = 10;  ///< words of a triangle and its key

    Chunk& chunk_;
    const GeometryTables& tables_;
    const BinaryTree& tree_;
    BvhData& bvh_;
    std::size_t next_triangle_;
};

std::size_t triangles_below(const BinaryTree& tree, const BinaryNode& node)
{
    if (node.leaf) return node.kinds == Item::triangle ? node.count : 0;
    return triangles_below(tree, tree.nodes[node.left]) + triangles_below(tree, tree.nodes[node.right]);
}

}  // namespace

int collect_children(const BinaryTree& tree, const BinaryNode& node, std::uint32_t* out)
{
    int count = 0;
    const int k = node.choices[0];
    collect(tree, node.left, k, out, count);
    collect(tree, node.right, bvh_width - k, out, count);
    return count;
}

int gather_ids(const BinaryTree& tree, const BinaryNode& node, std::uint32_t* out)
{
    if (node.leaf) {
        std::copy_n(&tree.ids[node.left], node.count, out);
        return int(node.count);
    }
    const int left = gather_ids(tree, tree.nodes[node.left], out);
    return left + gather_ids(tree, tree.nodes[node.right], out + left);
}

void Chunk::count_triangles(const BinaryTree& tree)
{
    triangles = triangles_below(tree, tree.nodes[from]);
}

void Chunk::write(const GeometryTables& tables, const BinaryTree& tree, BvhData& bvh)
{
    ChunkWriter(*this, tables, tree, bvh).run();
}

}  // namespace fathom::bvh
