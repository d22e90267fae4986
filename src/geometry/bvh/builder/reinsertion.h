#pragma once
/// Better binary trees by moving nodes to other places: Bittner, Hapala, Havran 2013, "Fast Insertion-Based
/// Optimization of Bounding Volume Hierarchies". Places are searched in parallel as by Meister and Bittner 2018,
/// "Parallel Reinsertion for Bounding Volume Hierarchy Optimization".
#include "geometry/bvh/builder/binary.h"

namespace fathom::bvh {

/// What a level of building spends on it.
struct Reinsertion {
    int rounds = 0;
    /// In each, such a part of the nodes is searched a better place for: those with the largest boxes, which cost the
    /// most for those that are moved.
    double part = 0;

    /// Of memory, beside the tree, at most.
    std::size_t bytes(std::size_t nodes) const;
};

/// Makes the sum of all inner nodes' areas smaller. Depends neither on the number of threads nor on their order.
void reinsert(BinaryTree& tree, const Reinsertion& reinsertion);

}  // namespace fathom::bvh
