#pragma once
/// What goes into the trees: boxes of triangles, quads, spheres, disks and instances.
#include "geometry/bvh/builder/split.h"
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

struct ItemList {
    LargeArray<Item> items;
    std::size_t count = 0, triangles = 0;  ///< items in use, and how many of them are triangles
    Box box;
    CenterBounds centers;
};

/// Boxes when the shutter opens and when it closes; in between they go linearly from one to the other.
struct MovingBox {
    Box open, close;

    void extend(const MovingBox& other)
    {
        open.extend(other.open);
        close.extend(other.close);
    }
    /// Half-way: both contain more than their mean does, and so does the middle of the motion.
    Box middle() const;
    /// The largest coordinate.
    float radius() const;
    /// Smallest such that it holds all of boxes, the i-th at time i of [0, 1].
    static MovingBox around(const float* times, const Box* boxes, std::size_t count);
};

/// Of one primitive; the kind and id are those of an item that make_items was asked for.
MovingBox moving_box(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes,
                     std::uint32_t kind, std::uint32_t id);

/// What of a shape's primitives can be hit. [first, last): primitives.
ItemList shape_items(const GeometryTables& tables, const BvhData& bvh, std::uint32_t first, std::uint32_t last);
/// Everything in the world, of instances those that are still, if the tables are editable; bvh.meshes and their boxes,
/// by shape, are known.
ItemList world_items(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes);
/// The other instances.
ItemList movable_items(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes);

}  // namespace fathom::bvh
