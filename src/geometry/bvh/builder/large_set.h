#pragma once
/// Splitting sets that are large enough for all threads.
#include "geometry/bvh/builder/split.h"

namespace fathom::bvh {

/// As split_objects, but in an order of items of its own; the same for any number of threads.
void split_large(const ItemSet& all, int depth, ItemSet& left, ItemSet& right);

}  // namespace fathom::bvh
