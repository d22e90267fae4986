// SPDX-License-Identifier: Apache-2.0
#include "session/deterministic_reduce.h"

#include <gtest/gtest.h>

#include <numeric>

namespace fathom {
namespace {

/// A sum that records numbers in order of arrival.
struct List {
    std::vector<std::size_t> numbers;

    void add(const List& o) { numbers.insert(numbers.end(), o.numbers.begin(), o.numbers.end()); }
};

/// Parts are added once and in order, because the bits of a float sum depend on it.
TEST(DeterministicReduce, AddsPartsInOrder)
{
    for (std::size_t parts : {0u, 1u, 7u, 8u, 9u, 100u}) {
        std::vector<std::size_t> all(parts);
        std::iota(all.begin(), all.end(), std::size_t(0));
        const List sum =
            deterministic_reduce(parts, List{}, [](std::size_t part, List& sums) { sums.numbers.push_back(part); });
        EXPECT_EQ(sum.numbers, all) << parts;
    }
}

/// Groups are summed separately: small numbers of one group vanish in a large number of another only at the end, for
/// any number of threads.
TEST(DeterministicReduce, AddsGroupsEachForItself)
{
    struct Sum {
        float value = 0;
        void add(const Sum& o) { value += o.value; }
    };
    // The groups have two parts: 2^24, which adding 1 does not change, followed by 2 repeatedly.
    const Sum sum =
        deterministic_reduce(16, Sum{}, [](std::size_t part, Sum& s) { s.value += part == 0 ? 0x1p24f : 1.0f; });
    EXPECT_EQ(sum.value, 0x1p24f + 14);
}

}  // namespace
}  // namespace fathom
