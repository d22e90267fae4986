#include "geometry/bvh/build/treelet.h"

#include <limits>

#include "geometry/bvh/build/morton.h"

namespace fathom::bvh {

namespace {

class TreeletBuilder {
public:
    TreeletBuilder(Treelet& treelet, const SpatialSplitter* splitter, std::size_t together, const Item* first_item,
                   std::uint32_t* ids)
        : nodes_(treelet.nodes), splitter_(splitter), together_(together), first_item_(first_item), ids_(ids)
    {
    }

    /// Adds the node of these items and all below.
    void split(const ItemSet& set, std::uint32_t parent, int depth)
    {
        const std::uint32_t self = add(set.items, set.count, parent);
        nodes_[self].set_box(set.box);
        if (nodes_[self].leaf) return;
        ItemSet left, right;
        if (splitter_)
            splitter_->split(set, depth, left, right);
        else
            split_objects(set, depth, left, right);
        nodes_[self].left = std::uint32_t(nodes_.size());
        split(left, self, depth + 1);
        nodes_[self].right = std::uint32_t(nodes_.size());
        split(right, self, depth + 1);
        set_height(nodes_[self]);
    }

    /// The same by codes; its box.
    Box split_sorted(Item* items, const std::uint32_t* codes, std::size_t n, std::uint32_t parent)
    {
        const std::uint32_t self = add(items, n, parent);
        Box box;
        if (nodes_[self].leaf) {
            for (std::size_t i = 0; i < n; ++i) box.extend(items[i]);
        } else {
            const std::size_t middle = morton_split(codes, n);
            nodes_[self].left = std::uint32_t(nodes_.size());
            box.extend(split_sorted(items, codes, middle, self));
            nodes_[self].right = std::uint32_t(nodes_.size());
            box.extend(split_sorted(items + middle, codes + middle, n - middle, self));
            set_height(nodes_[self]);
        }
        nodes_[self].set_box(box);
        return box;
    }

private:
    void set_height(BinaryNode& node) const { node.count = height_above(nodes_[node.left], nodes_[node.right]); }

    /// A leaf, if these can be one.
    std::uint32_t add(const Item* items, std::size_t n, std::uint32_t parent)
    {
        BinaryNode& node = nodes_.emplace_back();
        node = {};
        node.parent = parent;
        const std::uint32_t self = std::uint32_t(nodes_.size() - 1);
        if (n > together_) return self;
        std::uint32_t kinds = 0;
        for (std::size_t i = 0; i < n; ++i) kinds |= items[i].kind;
        if (!(leaf_cost(kinds, n) < std::numeric_limits<float>::infinity())) return self;
        const std::size_t first = std::size_t(items - first_item_);
        node.left = std::uint32_t(first);
        node.count = std::uint32_t(n);
        node.kinds = kinds & 255;
        node.leaf = true;
        for (std::size_t i = 0; i < n; ++i) ids_[first + i] = items[i].id;
        return self;
    }

    std::vector<BinaryNode>& nodes_;
    const SpatialSplitter* splitter_;
    std::size_t together_;
    const Item* first_item_;
    std::uint32_t* ids_;
};

}  // namespace

void Treelet::build(const SpatialSplitter* splitter, std::size_t together, const Item* first_item, std::uint32_t* ids)
{
    nodes.reserve(set.count);
    TreeletBuilder builder(*this, splitter, together, first_item, ids);
    if (codes)
        builder.split_sorted(set.items, codes, set.count, BinaryNode::none);
    else
        builder.split(set, BinaryNode::none, depth);
}

}  // namespace fathom::bvh
