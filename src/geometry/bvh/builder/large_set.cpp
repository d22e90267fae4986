// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/large_set.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <vector>

namespace fathom::bvh {

namespace {

/// Number of items that are worth a task. It determines the order of items, so it must not depend on the machine.
constexpr std::size_t part_size = 1 << 13;
constexpr std::size_t min_parts = 4;

Bins bins_of(const ItemSet& set, const BinMap& map)
{
    // Minima and counts do not depend on the order of reduction.
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, set.count, part_size), Bins(Bins::max),
        [&](const tbb::blocked_range<std::size_t>& range, const Bins& before) {
            Bins sum = before;
            sum.add(set.items + range.begin(), range.size(), map);
            return sum;
        },
        [](const Bins& a, const Bins& b) {
            Bins sum = a;
            sum.merge(b);
            return sum;
        });
}

/// Consecutive items that are partitioned at `middle`.
struct Part {
    std::size_t first, middle, end;
    CenterBounds left, right;
};

/// Swaps items of the right side before `middle` with items of the left side after it.
void join_sides(Item* items, const std::vector<Part>& parts, std::size_t middle)
{
    struct Swap {
        std::size_t a, b, n;
    };
    std::vector<Swap> swaps;
    auto from = parts.end();
    std::size_t begin = 0, end = 0;  // remainder of the current run
    for (const Part& p : parts)
        for (std::size_t a = p.middle; a < std::min(p.end, middle);) {
            while (begin == end) {
                --from;
                begin = std::max(from->first, middle);
                end = std::max(from->middle, begin);
            }
            const std::size_t n = std::min(std::min(p.end, middle) - a, end - begin);
            swaps.push_back({a, begin, n});
            a += n;
            begin += n;
        }
    tbb::parallel_for(std::size_t(0), swaps.size(), [&](std::size_t i) {
        const Swap& s = swaps[i];
        std::swap_ranges(items + s.a, items + s.a + s.n, items + s.b);
    });
}

std::size_t partition_in_parts(const ItemSet& all, const BinMap& map, const Split& split, CenterBounds& left,
                               CenterBounds& right)
{
    std::vector<Part> parts(all.count / part_size);
    tbb::parallel_for(std::size_t(0), parts.size(), [&](std::size_t i) {
        Part& p = parts[i];
        p.first = i * part_size;
        p.end = i + 1 == parts.size() ? all.count : p.first + part_size;
        p.middle = p.first + partition(all.items + p.first, p.end - p.first, map, split, p.left, p.right);
    });
    std::size_t middle = 0;
    for (const Part& p : parts) {
        middle += p.middle - p.first;
        left.extend(p.left);
        right.extend(p.right);
    }
    join_sides(all.items, parts, middle);
    return middle;
}

}  // namespace

void split_large(const ItemSet& all, int depth, ItemSet& left, ItemSet& right)
{
    if (all.count < min_parts * part_size || depth >= halving_depth) {
        split_objects(all, depth, left, right);
        return;
    }
    const BinMap map(all.centers, Bins::max);
    const Split split = best_split(bins_of(all, map), map);
    if (split.axis < 0) {
        split_at(all, split, map, left, right);
        return;
    }
    left = {all.items, partition_in_parts(all, map, split, left.centers, right.centers), 0, split.left, left.centers};
    right = {all.items + left.count, all.count - left.count, 0, split.right, right.centers};
}

}  // namespace fathom::bvh
