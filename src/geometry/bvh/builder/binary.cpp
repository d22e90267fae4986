// SPDX-License-Identifier: Apache-2.0
/// Top-down construction of the binary BVH. All threads split the upper tree together; then each treelet is built by
/// one thread. The result does not depend on the number of threads.
#include "geometry/bvh/builder/binary.h"

#include <tbb/parallel_invoke.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <memory>

#include "geometry/bvh/builder/large_set.h"
#include "geometry/bvh/builder/morton.h"
#include "geometry/bvh/builder/treelet.h"

namespace fathom::bvh {

namespace {

constexpr std::size_t treelet_size = 1 << 13, treelet_clusters = 1 << 9;

/// Sets of up to this many items stay unsplit if one leaf can hold them. Splitting sets of four takes half of the build
/// time.
constexpr std::size_t max_unsplit(BvhQuality level, bool cut)
{
    if (level != BvhQuality::high) return 4;
    return cut ? 3 : 2;
}

struct UpperNode {
    ItemSet set;
    std::unique_ptr<UpperNode> left, right;  ///< null for a treelet
};

class Splitting {
public:
    Splitting(const GeometryTables& tables, ItemList& list, BvhQuality level, bool cut) : list_(list), level_(level)
    {
        if (cut) splitter_ = std::make_unique<SpatialSplitter>(tables, list.box.half_area());
    }

    BinaryTree run()
    {
        BinaryTree tree;
        if (level_ == BvhQuality::fast) clusters_ = std::make_unique<Clusters>(cluster_by_morton_code(list_));
        UpperNode top;
        top.set = {list_.items.data(), list_.count, 0, list_.box, list_.centers};
        if (splitter_) make_room(top.set);
        const Item* const first_item = top.set.items;
        tree.ids = clusters_ ? std::move(clusters_->ids) : LargeArray<std::uint32_t>(top.set.count + top.set.room);
        split(top, 0);
        gather_treelets(top, 0);
        tree.nodes = LargeArray<BinaryNode>(2 * tree.ids.size());
        build_treelets(first_item, tree);
        place(top, BinaryNode::none, tree);
        const std::size_t before = list_.items.bytes() + (clusters_ ? clusters_->node_bytes : 0);
        list_.items = {};
        // Spatial splits need a second copy of the items.
        const std::size_t copies = before + std::size_t(splitter_ ? 1 : 0) * list_.count * sizeof(Item);
        tree.peak_bytes = std::max({clusters_ ? clusters_->peak_bytes : 0, copies, before + tree.bytes()});
        clusters_ = {};
        return tree;
    }

private:
    /// Reallocates the items with room for the additional pieces that spatial splits create.
    void make_room(ItemSet& set)
    {
        set.room = std::size_t(max_cuts * double(list_.triangles));
        LargeArray<Item> items(set.count + set.room);
        std::copy(set.items, set.items + set.count, items.data());
        list_.items = std::move(items);
        set.items = list_.items.data();
    }

    void split(UpperNode& node, int depth) const
    {
        if (node.set.count <= (clusters_ ? treelet_clusters : treelet_size)) return;
        node.left = std::make_unique<UpperNode>();
        node.right = std::make_unique<UpperNode>();
        ItemSet &left = node.left->set, &right = node.right->set;
        if (splitter_)
            splitter_->split(node.set, depth, left, right);
        else
            split_large(node.set, depth, left, right);
        tbb::parallel_invoke([&] { split(*node.left, depth + 1); }, [&] { split(*node.right, depth + 1); });
    }

    void gather_treelets(const UpperNode& node, int depth)
    {
        if (node.left) {
            ++upper_nodes_;
            gather_treelets(*node.left, depth + 1);
            gather_treelets(*node.right, depth + 1);
            return;
        }
        Treelet treelet;
        treelet.set = node.set;
        treelet.depth = depth;
        treelets_.push_back(std::move(treelet));
    }

    /// Builds treelets in parallel and appends their nodes in order as they finish, so that few finished treelets wait
    /// in memory.
    void build_treelets(const Item* first_item, BinaryTree& tree)
    {
        std::size_t next = 0, end = upper_nodes_;
        const std::size_t max_waiting = 4 * std::size_t(tbb::this_task_arena::max_concurrency());
        const auto take = [&](tbb::flow_control& control) -> Treelet* {
            if (next < treelets_.size()) return &treelets_[next++];
            control.stop();
            return nullptr;
        };
        const auto build = [&](Treelet* treelet) {
            treelet->build(splitter_.get(), max_unsplit(level_, splitter_ != nullptr), first_item, tree.ids.data(),
                           clusters_.get());
            return treelet;
        };
        const auto put = [&](Treelet* treelet) { append(treelet->nodes, end, tree); };
        using enum tbb::filter_mode;
        tbb::parallel_pipeline(max_waiting, tbb::make_filter<void, Treelet*>(serial_in_order, take) &
                                                tbb::make_filter<Treelet*, Treelet*>(parallel, build) &
                                                tbb::make_filter<Treelet*, void>(serial_in_order, put));
        tree.nodes.truncate(end);
    }

    /// Appends the nodes of a treelet to the tree and frees them.
    void append(std::vector<BinaryNode>& nodes, std::size_t& end, BinaryTree& tree)
    {
        if (end + nodes.size() >= BinaryNode::none) throw std::length_error("the scene has too many primitives");
        const auto root = std::uint32_t(end);
        for (BinaryNode node : nodes) {
            node.parent += root;
            if (!node.leaf) {
                node.left += root;
                node.right += root;
            }
            tree.nodes[end++] = node;
        }
        roots_.push_back(root);
        nodes = {};
    }

    /// Writes the upper nodes in depth-first order, in front of all treelets. Returns the index of the node.
    std::uint32_t place(const UpperNode& node, std::uint32_t parent, BinaryTree& tree)
    {
        if (!node.left) {
            const std::uint32_t root = roots_[next_treelet_++];
            tree.nodes[root].parent = parent;
            return root;
        }
        const std::uint32_t self = next_upper_++;
        BinaryNode& out = tree.nodes[self];
        out = {};
        out.parent = parent;
        out.left = place(*node.left, self, tree);
        out.right = place(*node.right, self, tree);
        Box box = tree.nodes[out.left].box();
        box.extend(tree.nodes[out.right].box());
        out.set_box(box);
        out.count = height_above(tree.nodes[out.left], tree.nodes[out.right]);
        return self;
    }

    ItemList& list_;
    BvhQuality level_;
    std::unique_ptr<SpatialSplitter> splitter_;
    std::unique_ptr<Clusters> clusters_;  ///< set if items are clusters, as at the fast level
    std::vector<Treelet> treelets_;
    std::vector<std::uint32_t> roots_;
    std::uint32_t upper_nodes_ = 0, next_upper_ = 0;
    std::size_t next_treelet_ = 0;
};

}  // namespace

BinaryTree split_items(const GeometryTables& tables, ItemList& list, BvhQuality level, bool cut)
{
    return Splitting(tables, list, level, cut).run();
}

}  // namespace fathom::bvh
