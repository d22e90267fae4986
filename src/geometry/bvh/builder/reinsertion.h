// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Optimization of binary BVHs by reinsertion: Bittner, Hapala, Havran 2013, "Fast Insertion-Based Optimization of
/// Bounding Volume Hierarchies". Positions are searched in parallel as by Meister and Bittner 2018, "Parallel
/// Reinsertion for Bounding Volume Hierarchy Optimization".
#include "geometry/bvh/builder/binary.h"

namespace fathom::bvh {

/// Effort of reinsertion at a quality level.
struct Reinsertion {
    int rounds = 0;
    /// Fraction of nodes to move per round: those with the largest boxes, which contribute most to the cost.
    double part = 0;

    /// Upper bound on memory besides the tree.
    std::size_t bytes(std::size_t nodes) const;
};

/// Reduces the sum of the areas of all inner nodes. The result does not depend on threads.
void reinsert(BinaryTree& tree, const Reinsertion& reinsertion);

}  // namespace fathom::bvh
