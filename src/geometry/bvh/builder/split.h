// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Binned splitting of sets of boxes by the surface area heuristic (SAH): Wald 2007, "On fast Construction of SAH-based
/// Bounding Volume Hierarchies".
#include <cstdint>
#include <cstring>
#include <limits>

namespace fathom::bvh {

// The builder uses compiler vectors instead of lanes because it works on whole boxes. Vectors of 32 bytes are passed by
// reference only: passing them by value depends on the instruction set.
using V4 = float __attribute__((vector_size(16)));
using V4i = std::int32_t __attribute__((vector_size(16)));
using V8 = float __attribute__((vector_size(32)));

/// A primitive or instance to build the tree over: bounding box, id and kind.
struct alignas(16) Item {
    enum Kind : std::uint32_t {
        triangle = 1,
        sphere = 2,
        disk = 4,
        instance = 8,
        moving_triangle = 16,
        curve = 32,
        ribbon = 64,
        point = 128
    };
    float low[3];
    std::uint32_t id;  ///< key of a triangle; piece_id of a curve piece; otherwise the primitive's index
    float minus_high[3];
    std::uint32_t kind;
};

/// Axis-aligned box stored as (low, -high), so that a union is one minimum. Lanes 3 and 7 are unused.
struct alignas(32) Box {
    V8 v;

    Box()
    {
        constexpr float inf = std::numeric_limits<float>::infinity();
        v = V8{inf, inf, inf, inf, inf, inf, inf, inf};
    }
    explicit Box(const Item& item) : Box(static_cast<const void*>(&item)) {}
    /// Loads the 32 bytes of an Item as a box. The id and kind are masked, since they would be slow denormal floats.
    explicit Box(const void* data)
    {
        using V8i = std::int32_t __attribute__((vector_size(32)));
        std::memcpy(&v, data, sizeof v);
        v = V8(V8i(v) & V8i{-1, -1, -1, 0, -1, -1, -1, 0});
    }
    void extend(const V8& other) { v = v < other ? v : other; }
    void extend(const Box& other) { extend(other.v); }
    void extend(const Item& item) { extend(Box(item)); }
    float low(int axis) const { return v[axis]; }
    float high(int axis) const { return -v[4 + axis]; }
    /// Negated size by axis; the fourth lane is undefined.
    V4 minus_size() const
    {
        return __builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7);
    }
    /// Twice the center of the box.
    V4 center2() const { return __builtin_shufflevector(v, v, 0, 1, 2, 3) - __builtin_shufflevector(v, v, 4, 5, 6, 7); }
    float half_area() const
    {
        const float x = high(0) - low(0), y = high(1) - low(1), z = high(2) - low(2);
        return x * y + (x + y) * z;
    }
};

/// Sets the box of an item; id and kind stay.
inline void set_box(Item& item, const Box& box)
{
    for (int axis = 0; axis < 3; ++axis) {
        item.low[axis] = box.v[axis];
        item.minus_high[axis] = box.v[4 + axis];
    }
}

/// Twice the center of the item's box.
inline V4 center2(const Item& item)
{
    V4 low, minus_high;
    std::memcpy(&low, &item.low, 16);
    std::memcpy(&minus_high, &item.minus_high, 16);
    const V4i xyz = {-1, -1, -1, 0};  // the fourth lane may be NaN
    return V4(V4i(low) & xyz) - V4(V4i(minus_high) & xyz);
}

/// Bounds of box centers: (low, -high) as in Box.
struct CenterBounds {
    V4 low, minus_high;

    CenterBounds()
    {
        constexpr float inf = std::numeric_limits<float>::infinity();
        low = minus_high = V4{inf, inf, inf, inf};
    }
    void extend(const V4& c)
    {
        const V4 m = -c;
        low = low < c ? low : c;
        minus_high = minus_high < m ? minus_high : m;
    }
    void extend(const CenterBounds& other)
    {
        low = low < other.low ? low : other.low;
        minus_high = minus_high < other.minus_high ? minus_high : other.minus_high;
    }
};

/// Contiguous items, followed by room for pieces that spatial splits may add.
struct ItemSet {
    Item* items = nullptr;
    std::size_t count = 0, room = 0;
    Box box;
    CenterBounds centers;
};

/// Maps box centers to bins, by axis.
struct BinMap {
    V4 base, scale;
    std::int32_t last;

    BinMap(const CenterBounds& bounds, int bins) : base(bounds.low), last(bins - 1)
    {
        for (int axis = 0; axis < 4; ++axis) {
            const float extent = axis < 3 ? -bounds.minus_high[axis] - bounds.low[axis] : 0.f;
            // If the inverse of an extent would overflow, the extent counts as 0.
            scale[axis] = extent > 1e-30f ? float(bins) * 0.9999f / extent : 0.f;
        }
    }
    V4i operator()(const V4& center) const
    {
        const V4i bin = __builtin_convertvector((center - base) * scale, V4i);
        const V4i top = {last, last, last, last};
        return bin < top ? bin : top;
    }
    bool splits(int axis) const { return scale[axis] > 0; }
};

/// Boxes and counts of items per bin, for all three axes.
struct Bins {
    static constexpr int max = 16;

    /// Creates empty bins; only the first `bins` are used.
    explicit Bins(int bins);
    /// Adds items to the bins of all three axes.
    void add(const Item* items, std::size_t n, const BinMap& map);
    /// Adds the contents of other bins of the same map.
    void merge(const Bins& other);

    int used;
    alignas(32) V8 box[max][3];  ///< boxes as in Box::v
    std::uint32_t count[max][4];
};

/// An object split: a bin boundary along an axis, with the boxes of both sides.
struct Split {
    int axis = -1;   ///< -1 if no split was found
    int bin = 0;     ///< bins 0 to this one go to the left side
    float cost = 0;  ///< area times number of items, summed over both sides
    Box left, right;
};

/// The best SAH split of the bins.
Split best_split(const Bins& bins, const BinMap& map);
/// The best SAH split of the items; the number of bins grows with the number of items.
Split find_split(const Item* items, std::size_t n, const CenterBounds& centers, BinMap& map);
/// Moves the items of the left side to the front and returns their number. Also computes the bounds of centers of both
/// sides.
std::size_t partition(Item* items, std::size_t n, const BinMap& map, const Split& split, CenterBounds& left,
                      CenterBounds& right);
/// Splits at least 2 items by find_split(), or in halves if it finds no split or the tree gets too deep. The sets must
/// have no room for pieces.
void split_objects(const ItemSet& all, int depth, ItemSet& left, ItemSet& right);
/// Splits the items at a split that find_split() found with this map, or in halves if it found none.
void split_at(const ItemSet& all, const Split& split, const BinMap& map, ItemSet& left, ItemSet& right);

/// From this depth on, sets are split in halves.
inline constexpr int halving_depth = 50;

}  // namespace fathom::bvh
