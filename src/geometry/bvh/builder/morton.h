#pragma once
/// Small trees of items that are neighbours in the order of their centres' Morton codes, over which the rest of the
/// tree is then built: there is less to split, and it is worse; see docs/performance.md. Pantaleoni and Luebke 2010,
/// "HLBVH".
#include <vector>

#include "geometry/bvh/builder/binary.h"

namespace fathom::bvh {

struct Clusters {
    /// Of how many items, as a power of two, a part is made.
    static constexpr int part_bits = 14;

    LargeArray<std::uint32_t> ids;               ///< of the items, in order
    std::vector<std::vector<BinaryNode>> nodes;  ///< by part, from which their numbers count; leaves count from ids
    std::size_t node_bytes = 0, peak_bytes = 0;  ///< of the nodes, and of all while they were made

    /// The nodes of the part that a cluster is in, and which of them is its root.
    const std::vector<BinaryNode>& part(std::uint32_t id) const { return nodes[id >> (part_bits + 1)]; }
    static std::uint32_t root(std::uint32_t id) { return id & ((2u << part_bits) - 1); }
};

/// Replaces the list's items by clusters of them; the same for any number of threads.
Clusters cluster_by_morton_code(ItemList& list);

}  // namespace fathom::bvh
