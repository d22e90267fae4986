// SPDX-License-Identifier: Apache-2.0
#include "geometry/bvh/builder/morton.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/bvh/builder/cost.h"

namespace fathom::bvh {

namespace {

constexpr int bits_per_axis = 10;
/// Number of items per task; clusters do not extend across tasks.
constexpr std::size_t cluster_part_size = std::size_t(1) << Clusters::part_bits;
/// Limits: items of a cluster, triangles of a leaf, and other items of a leaf.
constexpr std::size_t max_items = 32, max_triangles_in = 8, max_others = 4;

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

/// Calls what(part, first, end) in parallel for parts of fixed size, independent of the number of threads.
template <class What>
void for_parts(std::size_t n, const What& what)
{
    tbb::parallel_for(std::size_t(0), (n + cluster_part_size - 1) / cluster_part_size, [&](std::size_t part) {
        what(part, part * cluster_part_size, std::min(n, (part + 1) * cluster_part_size));
    });
}

/// Least significant digit radix sort; each pass is stable.
void radix_sort(LargeArray<Entry>& entries)
{
    constexpr int digit_bits = 10;
    constexpr std::size_t digits = 1 << digit_bits;
    const std::size_t n = entries.size(), parts = (n + cluster_part_size - 1) / cluster_part_size;
    LargeArray<Entry> other(n);
    std::vector<std::uint32_t> places(parts * digits);  // counts, later offsets, by part and digit
    for (int shift = 0; shift < 3 * bits_per_axis; shift += digit_bits) {
        const auto digit = [&](const Entry& e) { return e.code >> shift & (digits - 1); };
        std::fill(places.begin(), places.end(), 0);
        for_parts(n, [&](std::size_t part, std::size_t first, std::size_t end) {
            for (std::size_t i = first; i < end; ++i) ++places[part * digits + digit(entries[i])];
        });
        std::uint32_t sum = 0;
        for (std::size_t d = 0; d < digits; ++d)
            for (std::size_t part = 0; part < parts; ++part) sum += std::exchange(places[part * digits + d], sum);
        for_parts(n, [&](std::size_t part, std::size_t first, std::size_t end) {
            for (std::size_t i = first; i < end; ++i) other[places[part * digits + digit(entries[i])]++] = entries[i];
        });
        entries.swap(other);
    }
}

LargeArray<Entry> sorted_entries(const ItemList& list)
{
    const BinMap cell(list.centers, 1 << bits_per_axis);
    LargeArray<Entry> entries(list.count);
    for_parts(list.count, [&](std::size_t, std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
            const V4i c = cell(center2(list.items[i]));
            const std::uint32_t x = spread(std::uint32_t(c[0])), y = spread(std::uint32_t(c[1])),
                                z = spread(std::uint32_t(c[2]));
            entries[i] = {x | y << 1 | z << 2, std::uint32_t(i)};
        }
    });
    radix_sort(entries);
    return entries;
}

/// Index at which n sorted codes change in the highest bit that differs among them; the middle if all are equal.
std::size_t split_codes(const Entry* entries, std::size_t n)
{
    const std::uint32_t differ = entries[0].code ^ entries[n - 1].code;
    if (differ == 0) return n / 2;
    const std::uint32_t highest = std::bit_floor(differ);
    return std::size_t(std::partition_point(entries, entries + n, [&](const Entry& e) { return !(e.code & highest); }) -
                       entries);
}

/// Builds the clusters of one part.
class PartBuilder {
public:
    PartBuilder(const ItemList& list, const Entry* entries, std::uint32_t* ids, std::vector<BinaryNode>& nodes)
        : list_(list), entries_(entries), ids_(ids), nodes_(nodes)
    {
    }

    /// Splits items [first, end) into clusters; adds their nodes, and the index of each cluster's root to `roots`.
    void find(std::size_t first, std::size_t end, std::vector<std::uint32_t>& roots)
    {
        if (end - first <= max_items) {
            roots.push_back(add(first, end, BinaryNode::none));
            return;
        }
        const std::size_t middle = first + split_codes(entries_ + first, end - first);
        find(first, middle, roots);
        find(middle, end, roots);
    }

private:
    std::uint32_t add(std::size_t first, std::size_t end, std::uint32_t parent)
    {
        const auto self = std::uint32_t(nodes_.size());
        nodes_.emplace_back();
        BinaryNode node{};
        node.parent = parent;
        if (make_leaf(first, end, node)) return nodes_[self] = node, self;
        const std::size_t middle = first + split_codes(entries_ + first, end - first);
        node.left = add(first, middle, self);
        node.right = add(middle, end, self);
        const BinaryNode &left = nodes_[node.left], &right = nodes_[node.right];
        Box box = left.box();
        box.extend(right.box());
        node.set_box(box);
        node.count = height_above(left, right);
        nodes_[self] = node;
        return self;
    }

    bool make_leaf(std::size_t first, std::size_t end, BinaryNode& node)
    {
        const std::size_t n = end - first;
        if (n > max_triangles_in) return false;
        std::uint32_t kinds = 0;
        Box box;
        for (std::size_t i = first; i < end; ++i) {
            const Item& item = list_.items[entries_[i].index];
            kinds |= item.kind;
            box.extend(item);
            ids_[i] = item.id;
        }
        if (n > max_others && kinds != Item::triangle) return false;
        if (!(leaf_cost(kinds, n) < std::numeric_limits<float>::infinity())) return false;
        node.left = std::uint32_t(first);
        node.count = std::uint32_t(n);
        node.kinds = kinds & 255;
        node.leaf = true;
        node.set_box(box);
        return true;
    }

    const ItemList& list_;
    const Entry* entries_;
    std::uint32_t* ids_;
    std::vector<BinaryNode>& nodes_;
};

}  // namespace

Clusters cluster_by_morton_code(ItemList& list)
{
    const LargeArray<Entry> entries = sorted_entries(list);
    Clusters clusters;
    clusters.ids = LargeArray<std::uint32_t>(list.count);
    const std::size_t part_count = (list.count + cluster_part_size - 1) / cluster_part_size;
    clusters.nodes.resize(part_count);
    std::vector<std::vector<std::uint32_t>> roots(part_count);
    for_parts(list.count, [&](std::size_t part, std::size_t first, std::size_t end) {
        std::vector<BinaryNode>& nodes = clusters.nodes[part];
        nodes.reserve((end - first) / 2);
        PartBuilder(list, entries.data(), clusters.ids.data(), nodes).find(first, end, roots[part]);
    });
    std::size_t count = 0;
    for (std::size_t part = 0; part < part_count; ++part) {
        count += roots[part].size();
        clusters.node_bytes += clusters.nodes[part].size() * sizeof(BinaryNode);
    }
    LargeArray<Item> items(count);
    list.centers = {};
    Item* out = items.data();
    for (std::size_t part = 0; part < part_count; ++part)
        for (const std::uint32_t root : roots[part]) {
            const Box box = clusters.nodes[part][root].box();
            set_box(*out, box);
            out->id = std::uint32_t(part << (Clusters::part_bits + 1)) | root;
            out->kind = 0;
            list.centers.extend(box.center2());
            ++out;
        }
    clusters.peak_bytes = list.items.bytes() + 2 * entries.bytes() + clusters.ids.bytes() + clusters.node_bytes;
    list.items = std::move(items);
    list.count = count;
    return clusters;
}

}  // namespace fathom::bvh
