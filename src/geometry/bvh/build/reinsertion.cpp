#include "geometry/bvh/build/reinsertion.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace fathom::bvh {

namespace {

constexpr std::uint32_t none = BinaryNode::none;
/// What is worth a move, as a part of the area of the node's parent.
constexpr float least_gain = 1e-3f;
/// No node comes to lie deeper by a move: nested boxes would become a list, and traversal's stacks grow with depth.
constexpr std::uint32_t most_depth = 96;

/// Where a node wants to.
struct Move {
    std::uint32_t node, to;  ///< as a sibling of
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
    explicit Reinserter(BinaryTree& tree) : nodes_(tree.nodes.data()), size_(tree.nodes.size()) {}

    void run(const Reinsertion& how)
    {
        find_heights();
        for (int round = 0; round < how.rounds; ++round) {
            select(std::size_t(how.part * double(size_)));
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, moves_.size(), 64),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  std::vector<Place> waiting;
                                  for (std::size_t i = range.begin(); i < range.end(); ++i) find(moves_[i], waiting);
                              });
            moves_.erase(std::remove_if(moves_.begin(), moves_.end(), [](const Move& m) { return m.to == none; }),
                         moves_.end());
            // The best first; what they leave of others' gains is seen when it is their turn.
            std::sort(moves_.begin(), moves_.end(), [](const Move& a, const Move& b) {
                return a.gain != b.gain ? a.gain > b.gain : a.node < b.node;
            });
            std::size_t moved = 0;
            for (const Move& m : moves_) moved += apply(m);
            if (moved == 0) break;
        }
    }

private:
    struct Place {
        std::uint32_t node;
        float gain;  ///< area saved if what is moved came here, without the box around both
    };

    Box box(std::uint32_t i) const { return nodes_[i].box(); }
    float area(std::uint32_t i) const { return box(i).half_area(); }
    std::uint32_t sibling(std::uint32_t i) const
    {
        const BinaryNode& parent = nodes_[nodes_[i].parent];
        return parent.left == i ? parent.right : parent.left;
    }
    std::uint32_t height(std::uint32_t i) const { return nodes_[i].leaf ? 0 : std::uint32_t(nodes_[i].count); }

    void find_heights()
    {
        // Children stand behind their parents.
        for (std::size_t i = size_; i-- > 0;)
            if (!nodes_[i].leaf) nodes_[i].count = 1 + std::max(height(nodes_[i].left), height(nodes_[i].right));
    }

    /// The n nodes with the largest boxes: a node's is at least as large as those below.
    void select(std::size_t n)
    {
        moves_.clear();
        std::vector<std::pair<float, std::uint32_t>> heap;
        if (n < size_) heap.emplace_back(0.f, 0u);
        const auto less = [](const auto& a, const auto& b) {
            return a.first != b.first ? a.first < b.first : a.second > b.second;
        };
        while (!heap.empty() && moves_.size() < n) {
            std::pop_heap(heap.begin(), heap.end(), less);
            const std::uint32_t i = heap.back().second;
            heap.pop_back();
            if (i != 0) moves_.push_back({i, none, 0});
            if (nodes_[i].leaf) continue;
            for (std::uint32_t child : {nodes_[i].left, nodes_[i].right}) {
                heap.emplace_back(area(child), child);
                std::push_heap(heap.begin(), heap.end(), less);
            }
        }
        if (n < size_) return;
        for (std::uint32_t i = 1; i < size_; ++i) moves_.push_back({i, none, 0});
    }

    /// Goes up from the node, and at each step down into the other side as far as something may be gained there.
    void find(Move& move, std::vector<Place>& waiting) const
    {
        const std::uint32_t node = move.node;
        std::uint32_t pivot = nodes_[node].parent, below = node;
        if (pivot == 0) return;  // the root stays
        const Box moved = box(node);
        const float least = moved.half_area();
        float gain = area(pivot);
        move.gain = gain * least_gain;
        const auto offer = [&](std::uint32_t to, float saved) {
            if (!(saved > move.gain)) return;
            move.gain = saved;
            move.to = to;
        };
        Box rest;  // the pivot's without the node
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

    /// False if it is not possible any more, or gains nothing, after what was moved before.
    bool apply(const Move& move)
    {
        const std::uint32_t parent = nodes_[move.node].parent, old = sibling(move.node);
        if (parent == 0 || move.to == parent || move.to == old) return false;
        std::uint32_t depth = 0;
        for (std::uint32_t i = move.to; i != none; i = nodes_[i].parent, ++depth)
            if (i == move.node) return false;
        if (depth + 1 + std::max(height(move.node), height(move.to)) > most_depth) return false;
        if (remove(move.node) + insert(move.node, move.to) < 0) return true;
        remove(move.node);
        insert(move.node, old);
        return false;
    }

    /// With its parent. Returns by how much the sum of areas grows.
    double remove(std::uint32_t node)
    {
        const std::uint32_t parent = nodes_[node].parent, above = nodes_[parent].parent;
        replace(above, parent, sibling(node));
        return fit(above) - double(area(parent));
    }

    /// With the parent that was removed with it.
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

    /// Boxes and heights from a node up to the root; by how much areas grow.
    double fit(std::uint32_t i)
    {
        double growth = 0;
        for (; i != none; i = nodes_[i].parent) {
            BinaryNode& node = nodes_[i];
            const Box fitting = around(box(node.left), box(node.right));
            growth += double(fitting.half_area()) - double(node.box().half_area());
            node.set_box(fitting);
            node.count = 1 + std::max(height(node.left), height(node.right));
        }
        return growth;
    }

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
