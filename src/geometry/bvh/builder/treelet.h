// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Lower part of the binary tree, split by one thread down to leaves.
#include <vector>

#include "geometry/bvh/builder/binary.h"
#include "geometry/bvh/builder/morton.h"
#include "geometry/bvh/builder/spatial.h"

namespace fathom::bvh {

/// A set at the bottom of the upper tree, and the nodes built from it.
struct Treelet {
    ItemSet set;
    int depth = 0;
    std::vector<BinaryNode> nodes;  ///< the first node is the root; indices of children and parents are relative to it

    /// Builds the nodes. splitter: allows spatial splits if not null. together: sets of up to this many items stay
    /// unsplit if one leaf can hold them. ids: receives the item ids; leaves index it relative to first_item. clusters:
    /// the subtrees that the items stand for, or null if they are ordinary items.
    void build(const SpatialSplitter* splitter, std::size_t max_unsplit, const Item* first_item, std::uint32_t* ids,
               const Clusters* clusters);
};

}  // namespace fathom::bvh
