#include "session/deterministic_reduce.h"

#include <gtest/gtest.h>

#include <numeric>

namespace fathom {
namespace {

/// Numbers in the order in which they came.
struct List {
    std::vector<std::size_t> numbers;

    void add(const List& o) { numbers.insert(numbers.end(), o.numbers.begin(), o.numbers.end()); }
};

/// Each part once, and all in their order: on that the bits of a sum of floats depend.
TEST(SumOfGroups, AddsPartsInOrder)
{
    for (std::size_t parts : {0u, 1u, 7u, 8u, 9u, 100u}) {
        std::vector<std::size_t> all(parts);
        std::iota(all.begin(), all.end(), std::size_t(0));
        const List sum =
            deterministic_reduce(parts, List{}, [](std::size_t part, List& sums) { sums.numbers.push_back(part); });
        EXPECT_EQ(sum.numbers, all) << parts;
    }
}

/// Groups are added up each for itself: the small numbers of one are lost in the large one of another, wherever the
/// threads begin.
TEST(SumOfGroups, AddsGroupsEachForItself)
{
    struct Sum {
        float value = 0;
        void add(const Sum& o) { value += o.value; }
    };
    // Groups of two: 2^24, which 1 alone does not change, and then 2 again and again.
    const Sum sum =
        deterministic_reduce(16, Sum{}, [](std::size_t part, Sum& s) { s.value += part == 0 ? 0x1p24f : 1.0f; });
    EXPECT_EQ(sum.value, 0x1p24f + 14);
}

}  // namespace
}  // namespace fathom
