#include "geometry/bvh/build/morton.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace fathom::bvh {

namespace {

constexpr int bits_per_axis = 10;

std::uint32_t spread(std::uint32_t x)
{
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

struct Entry {
    std::uint32_t code, index;
};

/// Least digits first, each pass stable; one thread, as it is a small part of the building.
void radix_sort(std::vector<Entry>& entries)
{
    constexpr int digit_bits = 10;
    std::vector<Entry> other(entries.size());
    for (int shift = 0; shift < 3 * bits_per_axis; shift += digit_bits) {
        std::vector<std::size_t> begin((1u << digit_bits) + 1);
        const auto digit = [&](const Entry& e) { return e.code >> shift & ((1u << digit_bits) - 1); };
        for (const Entry& e : entries) ++begin[digit(e) + 1];
        for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
        for (const Entry& e : entries) other[begin[digit(e)]++] = e;
        entries.swap(other);
    }
}

}  // namespace

std::vector<std::uint32_t> sort_by_morton_code(ItemList& list)
{
    const BinMap cell(list.centers, 1 << bits_per_axis);
    std::vector<Entry> entries(list.count);
    const auto each = [&](const auto& what) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, list.count, 1 << 14), [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) what(i);
        });
    };
    each([&](std::size_t i) {
        const V4i c = cell(center2(list.items[i]));
        entries[i] = {spread(std::uint32_t(c[0])) | spread(std::uint32_t(c[1])) << 1 | spread(std::uint32_t(c[2])) << 2,
                      std::uint32_t(i)};
    });
    radix_sort(entries);
    LargeArray<Item> sorted(list.items.size());
    std::vector<std::uint32_t> codes(list.count);
    each([&](std::size_t i) {
        sorted[i] = list.items[entries[i].index];
        codes[i] = entries[i].code;
    });
    list.items.swap(sorted);
    return codes;
}

std::size_t morton_split(const std::uint32_t* codes, std::size_t n)
{
    const std::uint32_t differ = codes[0] ^ codes[n - 1];
    if (differ == 0) return n / 2;
    const std::uint32_t highest = std::bit_floor(differ);
    return std::size_t(std::partition_point(codes, codes + n, [&](std::uint32_t c) { return !(c & highest); }) - codes);
}

}  // namespace fathom::bvh
