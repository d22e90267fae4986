// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/collapse.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <stdexcept>

#include "geometry/bvh/builder/chunk.h"
#include "geometry/bvh/builder/leaf_data.h"

namespace fathom::bvh {

namespace {

constexpr std::uint32_t chunk_size = 1 << 12;
/// Subtrees above this depth are solved in separate tasks.
constexpr int parallel_depth = 10;

class Solver {
public:
    Solver(const GeometryTables& tables, BinaryTree& tree) : tables_(tables), tree_(tree) {}

    /// Finds the choices of a node and all nodes below, and the kinds and counts of inner nodes.
    Costs solve(std::uint32_t i, int depth)
    {
        BinaryNode& node = tree_.nodes[i];
        const float half_area = node.box().half_area();
        Costs costs;
        if (node.leaf) {
            costs.c.fill(half_area * leaf_cost(node.kinds, node.count));
            return costs;
        }
        Costs left, right;
        if (depth < parallel_depth) {
            tbb::parallel_invoke([&] { left = solve(node.left, depth + 1); },
                                 [&] { right = solve(node.right, depth + 1); });
        } else {
            left = solve(node.left, depth + 1);
            right = solve(node.right, depth + 1);
        }
        const BinaryNode &l = tree_.nodes[node.left], &r = tree_.nodes[node.right];
        node.kinds = l.kinds | r.kinds;
        node.count = std::min<std::uint32_t>(std::uint32_t(l.count) + r.count, BinaryNode::max_count);
        costs = join(left, right, half_area, leaf_cost(node.kinds, node.count), node.choices);
        // The test whether one leaf can hold the items is only made if a leaf would be best.
        if (node.choices[0] != 0 || fits(node)) return costs;
        if (node.count > bvh_width) {
            // The costs overflowed to infinity, so any valid division of the children is acceptable.
            node.choices.bits = 0x1111111111111111u;
            return costs;
        }
        return join(left, right, half_area, std::numeric_limits<float>::infinity(), node.choices);
    }

private:
    bool fits(const BinaryNode& node) const
    {
        if (node.count > bvh_width) return false;
        std::uint32_t ids[bvh_width];
        const int n = gather_ids(tree_, node, ids);
        return fit_together(tables_, node.kinds, ids, std::size_t(n));
    }

    const GeometryTables& tables_;
    BinaryTree& tree_;
};

class Collapse {
public:
    Collapse(const GeometryTables& tables, BinaryTree& tree, BvhData& bvh, std::size_t& next_triangle, bool compact)
        : tables_(tables), tree_(tree), bvh_(bvh), nodes_(bvh.nodes), next_triangle_(next_triangle), compact_(compact)
    {
    }

    Collapsed run()
    {
        bvh_.statistics.cost += expected_cost(tables_, tree_);
        gather_chunks(0);
        const auto each = [&](const auto& what) {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks_.size(), 1),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  for (std::size_t i = range.begin(); i < range.end(); ++i) what(chunks_[i]);
                              });
        };
        each([&](Chunk& c) { c.count_triangles(tree_); });
        std::size_t room = next_triangle_;
        for (Chunk& c : chunks_) {
            c.first_triangle = room;
            room += c.triangles;
        }
        each([&](Chunk& c) { c.write(tables_, tree_, bvh_); });
        std::size_t end_of_nodes = nodes_.size() + upper_nodes_, end_of_others = bvh_.others.size();
        for (Chunk& c : chunks_) {
            close_gap(c);
            bvh_.statistics.leaves += c.leaves;
            bvh_.statistics.nodes += c.nodes.size();
            bvh_.statistics.children += c.children;
            c.first_node = end_of_nodes;
            c.first_other = end_of_others;
            end_of_nodes += c.nodes.size();
            end_of_others += c.others.size();
        }
        if (end_of_others / BvhLeaf::unit > BvhReference::max_indexed)
            throw std::length_error("the scene has too many moving triangles");
        make_room(nodes_, end_of_nodes);
        make_room(bvh_.others, end_of_others + bvh_width);
        const std::uint32_t root = emit(0, 0).reference;
        // The binary tree is freed before the contents of chunks are copied, which limits peak memory.
        tree_ = {};
        nodes_.resize(end_of_nodes);
        each([&](Chunk& c) { place_nodes(c); });
        for (Chunk& c : chunks_) {
            bvh_.others.insert(bvh_.others.end(), c.others.begin(), c.others.end());
            c.others = {};
        }
        return {root, depth_};
    }

private:
    /// Reserves memory, with extra room so that frequent small additions are fast.
    template <class Vector>
    static void make_room(Vector& v, std::size_t size)
    {
        if (size > v.capacity()) v.reserve(std::max(size, v.size() * 3 / 2));
    }

    /// Lists the chunks in the order in which emit() visits them.
    void gather_chunks(std::uint32_t i)
    {
        const BinaryNode& node = tree_.nodes[i];
        if (is_chunk(node)) {
            chunks_.emplace_back().from = i;
            chunks_.back().compact = compact_;
            return;
        }
        ++upper_nodes_;
        std::uint32_t children[bvh_width];
        const int count = collect_children(tree_, node, children);
        for (int k = 0; k < count; ++k) gather_chunks(children[k]);
    }

    static bool is_chunk(const BinaryNode& node) { return becomes_leaf(node) || node.count <= chunk_size; }

    /// Moves the chunk's triangles up to the end of the previous chunk's: merging pieces of one triangle leaves gaps.
    void close_gap(Chunk& c)
    {
        c.moved = c.first_triangle - next_triangle_;
        const float* const triangles = compact_ ? c.triangles_apart.data() : &bvh_.triangles[9 * c.first_triangle];
        const BvhKey* const keys = compact_ ? c.keys_apart.data() : &bvh_.keys[c.first_triangle];
        if (c.triangles > 0 && (compact_ || c.moved > 0)) {
            std::memmove(&bvh_.triangles[9 * next_triangle_], triangles, 36 * c.triangles);
            std::memmove(&bvh_.keys[next_triangle_], keys, 4 * c.triangles);
        }
        next_triangle_ += c.triangles;
        c.triangles_apart = {};
        c.keys_apart = {};
    }

    /// Writes the wide nodes of the upper tree. depth: depth in the tree of wide nodes.
    Subtree emit(std::uint32_t i, int depth)
    {
        const BinaryNode& node = tree_.nodes[i];
        if (is_chunk(node)) {
            const Chunk& chunk = chunks_[next_chunk_++];
            depth_ = std::max(depth_, depth + chunk.depth);
            return placed_root(chunk);
        }
        const std::size_t self = nodes_.size();
        nodes_.emplace_back();
        std::uint32_t children[bvh_width];
        const int count = collect_children(tree_, node, children);
        Box boxes[bvh_width];
        Subtree subtrees[bvh_width];
        for (int k = 0; k < count; ++k) {
            boxes[k] = tree_.nodes[children[k]].box();
            subtrees[k] = emit(children[k], depth + 1);
        }
        ++bvh_.statistics.nodes;
        bvh_.statistics.children += std::size_t(count);
        Subtree all = finish_node(nodes_[self], boxes, subtrees, count);
        all.reference = std::uint32_t(self);
        return all;
    }

    /// Converts a reference that is relative to a chunk's arrays.
    static std::uint32_t place(const Chunk& chunk, std::uint32_t reference)
    {
        if (BvhReference::is_node(reference)) return std::uint32_t(reference + chunk.first_node);
        if (BvhReference::is_triangles(reference)) return std::uint32_t(reference - chunk.moved);
        const std::size_t first_leaf = chunk.first_other / BvhLeaf::unit;
        if (BvhReference::is_indexed_triangles(reference)) return std::uint32_t(reference + first_leaf);
        if (BvhReference::other_kind(reference) == BvhReference::instance) return reference;
        if (BvhReference::place(reference) + first_leaf >= BvhReference::max_others)
            throw std::length_error("the scene has too many spheres, disks, curves or points");
        return std::uint32_t(reference + first_leaf);
    }
    static Subtree placed_root(const Chunk& chunk)
    {
        Subtree root = chunk.root;
        root.reference = place(chunk, root.reference);
        return root;
    }

    /// Copies the chunk's nodes to the BVH's array and frees them.
    void place_nodes(Chunk& chunk)
    {
        for (BvhNode& node : chunk.nodes) {
            for (int i = 0; i < bvh_width && node.bounds[0][i] <= node.bounds[3][i]; ++i)
                node.child[i] = place(chunk, node.child[i]);
        }
        std::copy(chunk.nodes.begin(), chunk.nodes.end(), nodes_.begin() + std::ptrdiff_t(chunk.first_node));
        chunk.nodes = {};
    }

    const GeometryTables& tables_;
    BinaryTree& tree_;
    BvhData& bvh_;
    BvhNodes& nodes_;
    std::size_t& next_triangle_;
    const bool compact_;
    std::vector<Chunk> chunks_;
    std::size_t next_chunk_ = 0, upper_nodes_ = 0;
    int depth_ = 0;
};

}  // namespace

float expected_cost(const GeometryTables& tables, BinaryTree& tree)
{
    const float cost = Solver(tables, tree).solve(0, 0).c[0];
    tree.counted = true;
    return cost / std::max(tree.nodes[0].box().half_area(), std::numeric_limits<float>::min());
}

Collapsed collapse(const GeometryTables& tables, BinaryTree& tree, BvhData& bvh, std::size_t& next_triangle,
                   bool compact)
{
    return Collapse(tables, tree, bvh, next_triangle, compact).run();
}

}  // namespace fathom::bvh
