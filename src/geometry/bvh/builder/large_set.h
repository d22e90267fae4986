// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Parallel splitting of large sets.
#include "geometry/bvh/builder/split.h"

namespace fathom::bvh {

/// split_objects() with all threads. The order of items differs from that of split_objects(), but does not depend on
/// the number of threads.
void split_large(const ItemSet& all, int depth, ItemSet& left, ItemSet& right);

}  // namespace fathom::bvh
