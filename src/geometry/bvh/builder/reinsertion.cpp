// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/reinsertion.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace fathom::bvh {

namespace {

constexpr std::uint32_t no_node = BinaryNode::none;
/// Smallest gain worth a move, relative to the area of the node's parent.
constexpr float min_gain = 1e-3f;
/// Moves must not put a node deeper than this: nested boxes would degenerate to a list, and traversal stacks grow with
/// depth.
constexpr std::uint32_t max_depth = 96;
/// Subtrees above this depth are separate tasks.
constexpr int parallel_depth = 10;

/// A planned move of a node.
struct Move {
    std::uint32_t node, to;  ///< node to move, and its future sibling
    float gain;
};

Box around(const Box& a, const Box& b)
{
    Box both = a;
    both.extend(b);
    return both;
}

class Reinserter {
public:
    explicit Reinserter(BinaryTree& tree) : tree_(tree), nodes_(tree.nodes.data()), size_(tree.nodes.size()) {}

    void run(const Reinsertion& how)
    {
        if (tree_.counted) find_height(0, 0);
        tree_.counted = false;
        for (int round = 0; round < how.rounds; ++round) {
            select(std::size_t(how.part * double(size_)));
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, moves_.size(), 64),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  std::vector<Place> waiting;
                                  for (std::size_t i = range.begin(); i < range.end(); ++i) find(moves_[i], waiting);
                              });
            moves_.erase(std::remove_if(moves_.begin(), moves_.end(), [](const Move& m) { return m.to == no_node; }),
                         moves_.end());
            // The best moves come first; apply() checks the gain that remains after earlier moves.
            std::sort(moves_.begin(), moves_.end(), before);
            std::size_t moved = 0;
            for (const Move& m : moves_) moved += apply(m);
            if (moved == 0) break;
        }
    }

private:
    struct Place {
        std::uint32_t node;
        float gain;  ///< area that is saved if the node is inserted here, before subtracting the area of the box around
                     ///< both
    };

    Box box(std::uint32_t i) const { return nodes_[i].box(); }
    float area(std::uint32_t i) const { return box(i).half_area(); }
    std::uint32_t sibling(std::uint32_t i) const
    {
        const BinaryNode& parent = nodes_[nodes_[i].parent];
        return parent.left == i ? parent.right : parent.left;
    }

    void find_height(std::uint32_t i, int depth)
    {
        BinaryNode& node = nodes_[i];
        if (node.leaf) return;
        if (depth < parallel_depth) {
            tbb::parallel_invoke([&] { find_height(node.left, depth + 1); },
                                 [&] { find_height(node.right, depth + 1); });
        } else {
            find_height(node.left, depth + 1);
            find_height(node.right, depth + 1);
        }
        node.count = height_above(nodes_[node.left], nodes_[node.right]);
    }

    static bool before(const Move& a, const Move& b) { return a.gain != b.gain ? a.gain > b.gain : a.node < b.node; }

    /// Area that about n nodes exceed, estimated from a subset.
    float area_exceeded_by(std::size_t n) const
    {
        const std::size_t step = size_ < 1 << 14 ? 1 : 32;
        std::vector<float> areas;
        for (std::size_t i = 0; i < size_; i += step) areas.push_back(area(std::uint32_t(i)));
        const auto place = areas.begin() + std::ptrdiff_t(std::min(n / step, areas.size() - 1));
        std::nth_element(areas.begin(), place, areas.end(), std::greater<>());
        return *place;
    }

    /// Selects about n nodes with the largest boxes, as moves without a target; gains hold their areas.
    void select(std::size_t n)
    {
        moves_.clear();
        if (n >= size_) {
            for (std::uint32_t i = 1; i < size_; ++i) moves_.push_back({i, no_node, 0});
            return;
        }
        // A node's box is at least as large as the boxes below it, so the search can prune.
        const float least = area_exceeded_by(n + n / 4);
        std::vector<std::uint32_t> waiting{0};
        while (!waiting.empty() && moves_.size() < 2 * n) {
            const BinaryNode& node = nodes_[waiting.back()];
            waiting.pop_back();
            if (node.leaf) continue;
            for (std::uint32_t child : {node.left, node.right}) {
                const float a = area(child);
                if (!(a >= least)) continue;
                moves_.push_back({child, no_node, a});
                waiting.push_back(child);
            }
        }
        if (n < moves_.size()) {
            std::nth_element(moves_.begin(), moves_.begin() + std::ptrdiff_t(n), moves_.end(), before);
            moves_.resize(n);
        }
    }
    /// Branch-and-bound search for the best position: walks up from the node, and at each step searches the other side
    /// as far as a gain is possible there.
    void find(Move& move, std::vector<Place>& waiting) const
    {
        const std::uint32_t node = move.node;
        std::uint32_t pivot = nodes_[node].parent, below = node;
        if (pivot == 0) return;  // the root is not moved
        const Box moved = box(node);
        const float least = moved.half_area();
        float gain = area(pivot);
        move.gain = gain * min_gain;
        const auto offer = [&](std::uint32_t to, float saved) {
            if (!(saved > move.gain)) return;
            move.gain = saved;
            move.to = to;
        };
        Box rest;  // bounding box of the pivot without the node
        for (;;) {
            const std::uint32_t side = sibling(below);
            waiting.push_back({side, gain});
            while (!waiting.empty()) {
                const Place place = waiting.back();
                waiting.pop_back();
                if (!(place.gain - least > move.gain)) continue;
                const BinaryNode& at = nodes_[place.node];
                const Box old = at.box();
                const float joined = around(old, moved).half_area();
                offer(place.node, place.gain - joined);
                if (at.leaf) continue;
                const float further = place.gain - (joined - old.half_area());
                if (!(further - least > move.gain)) continue;
                waiting.push_back({at.left, further});
                waiting.push_back({at.right, further});
            }
            rest.extend(box(side));
            if (pivot == 0) return;
            if (below != node) {
                const float whole = area(pivot);
                gain += whole - rest.half_area();
                offer(pivot, gain - whole);
            }
            below = pivot;
            pivot = nodes_[pivot].parent;
        }
    }

    /// Performs a move; returns false if earlier moves made it impossible or unprofitable.
    bool apply(const Move& move)
    {
        const std::uint32_t parent = nodes_[move.node].parent, old = sibling(move.node);
        if (parent == 0 || move.to == parent || move.to == old) return false;
        std::uint32_t depth = 0;
        for (std::uint32_t i = move.to; i != no_node; i = nodes_[i].parent, ++depth)
            if (i == move.node) return false;
        if (depth + height_above(nodes_[move.node], nodes_[move.to]) > max_depth) return false;
        if (remove(move.node) + insert(move.node, move.to) < 0) return true;
        remove(move.node);
        insert(move.node, old);
        return false;
    }

    /// Removes a node and its parent. Returns the change of the sum of areas.
    double remove(std::uint32_t node)
    {
        const std::uint32_t parent = nodes_[node].parent, above = nodes_[parent].parent;
        replace(above, parent, sibling(node));
        return fit(above) - double(area(parent));
    }

    /// Inserts a node as a sibling of `at`, with the parent that was removed with it. Returns the change of the sum of
    /// areas.
    double insert(std::uint32_t node, std::uint32_t at)
    {
        const std::uint32_t parent = nodes_[node].parent, above = nodes_[at].parent;
        const double before = area(parent);
        replace(above, at, parent);
        nodes_[parent].left = at;
        nodes_[parent].right = node;
        nodes_[at].parent = parent;
        return before + fit(parent);
    }

    void replace(std::uint32_t parent, std::uint32_t child, std::uint32_t by)
    {
        (nodes_[parent].left == child ? nodes_[parent].left : nodes_[parent].right) = by;
        nodes_[by].parent = parent;
    }

    /// Updates boxes and heights from a node up to the root. Returns the change of the sum of areas.
    double fit(std::uint32_t i)
    {
        double growth = 0;
        for (; i != no_node; i = nodes_[i].parent) {
            BinaryNode& node = nodes_[i];
            const Box fitting = around(box(node.left), box(node.right));
            growth += double(fitting.half_area()) - double(node.box().half_area());
            node.set_box(fitting);
            node.count = height_above(nodes_[node.left], nodes_[node.right]);
        }
        return growth;
    }

    BinaryTree& tree_;
    BinaryNode* nodes_;
    std::size_t size_;
    std::vector<Move> moves_;
};

}  // namespace

std::size_t Reinsertion::bytes(std::size_t nodes) const
{
    return rounds == 0 ? 0 : std::size_t(part * double(nodes)) * (sizeof(Move) + 2 * sizeof(std::pair<float, int>));
}

void reinsert(BinaryTree& tree, const Reinsertion& reinsertion)
{
    Reinserter(tree).run(reinsertion);
}

}  // namespace fathom::bvh
