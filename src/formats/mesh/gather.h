// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

namespace fathom {

/// Replaces the values of vertices by those at the indices. An empty array, of an attribute that a mesh lacks, stays
/// empty.
template <class T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& indices)
{
    if (values.empty()) return;
    std::vector<T> gathered;
    gathered.reserve(indices.size());
    for (const std::uint32_t i : indices) gathered.push_back(values[i]);
    values = std::move(gathered);
}

}  // namespace fathom
