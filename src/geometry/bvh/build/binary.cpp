/// The upper part of the tree is split by all threads together, then treelets by one thread each. Nothing depends on
/// the number of threads.
#include "geometry/bvh/build/binary.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <memory>

#include "geometry/bvh/build/morton.h"
#include "geometry/bvh/build/treelet.h"

namespace fathom::bvh {

namespace {

constexpr std::size_t treelet_size = 1 << 15;
constexpr std::size_t parallel_binning = 1 << 17;

/// So many items stay together where one leaf can hold them: to split four takes half of the time.
constexpr std::size_t together(TreeBuild level, bool cut)
{
    if (level != TreeBuild::high) return 4;
    return cut ? 3 : 2;
}

struct UpperNode {
    ItemSet set;
    const std::uint32_t* codes = nullptr;    ///< as in Treelet
    std::unique_ptr<UpperNode> left, right;  ///< none: a treelet
};

Split parallel_split(const ItemSet& set, BinMap& map)
{
    if (set.count < parallel_binning) return find_split(set.items, set.count, set.centers, map);
    map = BinMap(set.centers, Bins::max);
    // Minima and counts: the same in any order.
    const Bins bins = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, set.count, parallel_binning / 8), Bins(Bins::max),
        [&](const tbb::blocked_range<std::size_t>& range, const Bins& before) {
            Bins sum = before;
            sum.add(set.items + range.begin(), range.size(), map);
            return sum;
        },
        [](const Bins& a, const Bins& b) {
            Bins sum = a;
            sum.merge(b);
            return sum;
        });
    return best_split(bins, map);
}

class Splitting {
public:
    Splitting(const GeometryTables& tables, ItemList& list, TreeBuild level, bool cut) : list_(list), level_(level)
    {
        if (cut) splitter_ = std::make_unique<SpatialSplitter>(tables, list.box.half_area());
    }

    BinaryTree run()
    {
        std::vector<std::uint32_t> codes;
        if (level_ == TreeBuild::fast) codes = sort_by_morton_code(list_);
        UpperNode top;
        top.set = {list_.items.data(), list_.count, 0, list_.box, list_.centers};
        top.codes = codes.empty() ? nullptr : codes.data();
        if (splitter_) make_room(top.set);
        const Item* const first_item = top.set.items;
        BinaryTree tree;
        tree.ids = LargeArray<std::uint32_t>(top.set.count + top.set.room);
        split(top, 0);
        gather_treelets(top, 0);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, treelets_.size(), 1),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  treelets_[i].build(splitter_.get(), together(level_, splitter_ != nullptr),
                                                     first_item, tree.ids.data());
                          });
        const std::size_t before = list_.items.bytes() + codes.size() * sizeof(std::uint32_t);
        list_.items = {};
        unite(top, tree);
        // Sorting and cutting copy the items; nodes are copied one treelet after the other.
        const std::size_t copies = before + std::size_t(splitter_ || top.codes ? 1 : 0) * list_.count * sizeof(Item);
        tree.peak_bytes = std::max(copies, before + tree.bytes());
        return tree;
    }

private:
    /// For as many pieces more as the items may be cut into.
    void make_room(ItemSet& set)
    {
        set.room = std::size_t(most_cuts * double(list_.triangles));
        LargeArray<Item> items(set.count + set.room);
        std::copy(set.items, set.items + set.count, items.data());
        list_.items = std::move(items);
        set.items = list_.items.data();
    }

    void split(UpperNode& node, int depth) const
    {
        if (node.set.count <= treelet_size) return;
        node.left = std::make_unique<UpperNode>();
        node.right = std::make_unique<UpperNode>();
        ItemSet &left = node.left->set, &right = node.right->set;
        if (node.codes) {
            // Boxes are found when the treelets are built.
            left.items = node.set.items;
            left.count = morton_split(node.codes, node.set.count);
            right.items = left.items + left.count;
            right.count = node.set.count - left.count;
            node.left->codes = node.codes;
            node.right->codes = node.codes + left.count;
        } else if (splitter_) {
            splitter_->split(node.set, depth, left, right);
        } else {
            BinMap map(node.set.centers, Bins::max);
            split_at(node.set, depth < halving_depth ? parallel_split(node.set, map) : Split(), map, left, right);
        }
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
        treelet.codes = node.codes;
        treelets_.push_back(std::move(treelet));
    }

    /// The upper nodes, then the treelets.
    void unite(const UpperNode& top, BinaryTree& tree)
    {
        std::size_t size = upper_nodes_;
        for (const Treelet& t : treelets_) {
            roots_.push_back(std::uint32_t(size));
            size += t.nodes.size();
        }
        if (size >= BinaryNode::none) throw std::length_error("the scene has too many primitives");
        tree.nodes = LargeArray<BinaryNode>(size);
        tbb::parallel_for(std::size_t(0), treelets_.size(), [&](std::size_t i) {
            std::vector<BinaryNode>& nodes = treelets_[i].nodes;
            const std::uint32_t root = roots_[i];
            for (BinaryNode& node : nodes) {
                node.parent += root;
                if (node.leaf) continue;
                node.left += root;
                node.right += root;
            }
            std::copy(nodes.begin(), nodes.end(), &tree.nodes[root]);
            nodes = {};
        });
        place(top, BinaryNode::none, tree);
    }

    /// Upper nodes in front of what is below them; its number.
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
        return self;
    }

    ItemList& list_;
    TreeBuild level_;
    std::unique_ptr<SpatialSplitter> splitter_;
    std::vector<Treelet> treelets_;
    std::vector<std::uint32_t> roots_;
    std::uint32_t upper_nodes_ = 0, next_upper_ = 0;
    std::size_t next_treelet_ = 0;
};

}  // namespace

BinaryTree split_items(const GeometryTables& tables, ItemList& list, TreeBuild level, bool cut)
{
    return Splitting(tables, list, level, cut).run();
}

}  // namespace fathom::bvh
