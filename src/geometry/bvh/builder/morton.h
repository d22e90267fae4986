// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Clusters of items that are adjacent in Morton order; the rest of the BVH is built over them. That is faster because
/// fewer items are split, at some loss of quality: Pantaleoni and Luebke 2010, "HLBVH".
#include <vector>

#include "geometry/bvh/builder/binary.h"

namespace fathom::bvh {

/// Clusters, each a small binary tree.
struct Clusters {
    /// Binary logarithm of the number of items per part.
    static constexpr int part_bits = 14;

    LargeArray<std::uint32_t> ids;  ///< ids of the items, in Morton order
    std::vector<std::vector<BinaryNode>>
        nodes;  ///< nodes by part; indices of nodes are relative to the part, leaves index `ids`
    std::size_t node_bytes = 0, peak_bytes = 0;  ///< memory of the nodes, and peak memory of construction

    /// The nodes of the part that contains a cluster; root() is the index of the cluster's root among them.
    const std::vector<BinaryNode>& part(std::uint32_t id) const { return nodes[id >> (part_bits + 1)]; }
    static std::uint32_t root(std::uint32_t id) { return id & ((2u << part_bits) - 1); }
};

/// Replaces the items of the list by clusters; the result does not depend on the number of threads.
Clusters cluster_by_morton_code(ItemList& list);

}  // namespace fathom::bvh
