#pragma once
/// Items in the order of their centres' Morton codes: Lauterbach et al. 2009, "Fast BVH Construction on GPUs". Trees
/// made of that take half the time and are worse; see docs/performance.md.
#include <vector>

#include "geometry/bvh/build/items.h"

namespace fathom::bvh {

/// Sorts the list's items; their codes, of 10 bits an axis. Items of one code keep their order.
std::vector<std::uint32_t> sort_by_morton_code(ItemList& list);

/// Where n sorted codes change in the highest bit that differs among them; the middle if none does.
std::size_t morton_split(const std::uint32_t* codes, std::size_t n);

}  // namespace fathom::bvh
