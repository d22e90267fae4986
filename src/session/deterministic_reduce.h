// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include <tbb/parallel_for.h>

namespace fathom {

/// Parallel sum whose result doesn't depend on the number of threads: a fixed number of groups is summed in parallel,
/// each in order of its parts; then the groups are added in order.
///
/// zero  neutral element, which has a method add(Sums)
/// add   function add(part, sums) that adds a part to sums
template <class Sums, class Add>
Sums deterministic_reduce(std::size_t parts, const Sums& zero, const Add& add)
{
    constexpr std::size_t groups = 8;
    std::vector<Sums> sums(groups, zero);
    tbb::parallel_for(std::size_t(0), groups, [&](std::size_t group) {
        for (std::size_t part = group * parts / groups; part < (group + 1) * parts / groups; ++part)
            add(part, sums[group]);
    });
    for (std::size_t group = 1; group < groups; ++group) sums[0].add(sums[group]);
    return std::move(sums[0]);
}

}  // namespace fathom
