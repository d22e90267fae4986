#pragma once
/// The lower part of the binary tree: up to some ten thousand items, split down to a few by one thread.
#include <vector>

#include "geometry/bvh/builder/binary.h"
#include "geometry/bvh/builder/morton.h"
#include "geometry/bvh/builder/spatial.h"

namespace fathom::bvh {

/// A set at the bottom of the upper tree, and what becomes of it.
struct Treelet {
    ItemSet set;
    int depth = 0;
    std::vector<BinaryNode> nodes;  ///< the first is its root; children and parents count from it

    /// Items may be cut if there is a splitter.
    /// together  so many items stay together where one leaf can hold them
    /// ids  gets those of all items, where these stand behind first_item, from which leaves count
    /// clusters  what items are, of which each becomes its own tree; null: they are just items
    void build(const SpatialSplitter* splitter, std::size_t together, const Item* first_item, std::uint32_t* ids,
               const Clusters* clusters);
};

}  // namespace fathom::bvh
