// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/treelet.h"

#include <limits>

#include "geometry/bvh/builder/morton.h"

namespace fathom::bvh {

namespace {

class TreeletBuilder {
public:
    TreeletBuilder(Treelet& treelet, const SpatialSplitter* splitter, std::size_t max_unsplit, const Item* first_item,
                   std::uint32_t* ids, const Clusters* clusters)
        : nodes_(treelet.nodes),
          splitter_(splitter),
          together_(max_unsplit),
          first_item_(first_item),
          ids_(ids),
          clusters_(clusters)
    {
    }

    /// Adds the node of these items and everything below it.
    void split(const ItemSet& set, std::uint32_t parent, int depth)
    {
        if (clusters_ && set.count == 1) {
            copy(clusters_->part(set.items->id), Clusters::root(set.items->id), parent);
            return;
        }
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

private:
    void set_height(BinaryNode& node) const { node.count = height_above(nodes_[node.left], nodes_[node.right]); }

    /// Copies a cluster's node and everything below it.
    std::uint32_t copy(const std::vector<BinaryNode>& from, std::uint32_t i, std::uint32_t parent)
    {
        const auto self = std::uint32_t(nodes_.size());
        nodes_.push_back(from[i]);
        nodes_[self].parent = parent;
        if (from[i].leaf) return self;
        const std::uint32_t left = copy(from, from[i].left, self);
        const std::uint32_t right = copy(from, from[i].right, self);
        nodes_[self].left = left;
        nodes_[self].right = right;
        return self;
    }

    /// Adds a node, which is a leaf if the items can form one.
    std::uint32_t add(const Item* items, std::size_t n, std::uint32_t parent)
    {
        BinaryNode& node = nodes_.emplace_back();
        node = {};
        node.parent = parent;
        const std::uint32_t self = std::uint32_t(nodes_.size() - 1);
        if (n > together_ || clusters_) return self;
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
    const Clusters* clusters_;
};

}  // namespace

void Treelet::build(const SpatialSplitter* splitter, std::size_t max_unsplit, const Item* first_item,
                    std::uint32_t* ids, const Clusters* clusters)
{
    nodes.reserve(clusters ? 10 * set.count : set.count);
    TreeletBuilder(*this, splitter, max_unsplit, first_item, ids, clusters).split(set, BinaryNode::none, depth);
}

}  // namespace fathom::bvh
