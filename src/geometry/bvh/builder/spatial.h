#pragma once
/// Splits of space instead of objects, which cut triangles in two where that is better: Stich, Friedrich and Dietrich
/// 2009, "Spatial Splits in Bounding Volume Hierarchies".
#include "geometry/bvh/builder/items.h"

namespace fathom::bvh {

/// At most so many pieces more than there are triangles, as a part of their number.
inline constexpr double max_cuts = 0.3;

/// Splits by objects or by space, whichever is better. Pieces of a triangle have its id; together their boxes hold all
/// of it.
class SpatialSplitter {
public:
    /// root_area: half that of the box of everything.
    SpatialSplitter(const GeometryTables& tables, float root_area) : tables_(tables), root_area_(root_area) {}

    /// In place, of at least 2 items; both sides get their part of the room that is left. depth: of `all`, in the tree.
    void split(const ItemSet& all, int depth, ItemSet& left, ItemSet& right) const;

private:
    struct Plane {
        int axis = -1;  ///< none
        float at = 0, cost = 0;
        std::size_t cuts = 0;
    };
    Plane best_plane(const ItemSet& all) const;
    bool divide(const ItemSet& all, const Plane& plane, ItemSet& left, ItemSet& right) const;
    void cut(const Item& whole, int axis, float at, Item& left, Item& right) const;

    const GeometryTables& tables_;
    float root_area_;
};

}  // namespace fathom::bvh
