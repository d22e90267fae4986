// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Spatial splits, which may cut triangles in two: Stich, Friedrich and Dietrich 2009, "Spatial Splits in Bounding
/// Volume Hierarchies".
#include "geometry/bvh/builder/items.h"

namespace fathom::bvh {

/// Limit on additional pieces, relative to the number of triangles.
inline constexpr double max_cuts = 0.3;

/// Splits by objects or by space, whichever costs less. Pieces of a triangle have its id; together their boxes contain
/// it.
class SpatialSplitter {
public:
    /// root_area: half the surface area of the scene's bounding box.
    SpatialSplitter(const GeometryTables& tables, float root_area) : tables_(tables), root_area_(root_area) {}

    /// Splits at least 2 items in place and divides the remaining room between both sides. depth: depth of `all` in the
    /// tree.
    void split(const ItemSet& all, int depth, ItemSet& left, ItemSet& right) const;

private:
    struct Plane {
        int axis = -1;  ///< -1 if no plane was found
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
