#pragma once
/// Splits of space instead of objects, which cut triangles in two where that is better: Stich, Friedrich and Dietrich
/// 2009, "Spatial Splits in Bounding Volume Hierarchies".
#include <vector>

#include "geometry/bvh_items.h"

namespace fathom::bvh {

/// At most so many pieces more than there are triangles, as a part of their number.
inline constexpr double most_cuts = 0.3;

/// Items of one side, with room of their own: a split can make them more.
struct ItemSide {
    std::vector<Item> items;
    Box box;
    CenterBounds centers;
    std::size_t budget = 0;  ///< how many more they may become

    void add(const Item& item)
    {
        items.push_back(item);
        box.extend(item);
        centers.extend(center2(item));
    }
};

/// Splits by objects or by space, whichever is better. Pieces of a triangle have its id; together their boxes hold all
/// of it.
class SpatialSplitter {
public:
    /// root_area: half that of the box of everything.
    SpatialSplitter(const SceneTables& tables, float root_area) : tables_(tables), root_area_(root_area) {}

    /// Empties `all`, of at least 2 items. depth: of it, in the tree.
    void split(ItemSide& all, int depth, ItemSide& left, ItemSide& right) const;

private:
    struct Plane {
        int axis = -1;  ///< none
        float at = 0, cost = 0;
        std::size_t cuts = 0;
    };
    Plane best_plane(const ItemSide& all) const;
    void divide(const ItemSide& all, const Plane& plane, ItemSide& left, ItemSide& right) const;
    void cut(const Item& whole, int axis, float at, Item& left, Item& right) const;

    const SceneTables& tables_;
    float root_area_;
};

}  // namespace fathom::bvh
