// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Items of BVHs: boxes of triangles, quads, spheres, disks, curve pieces, points and instances.
#include "geometry/bvh/builder/split.h"
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// Items with their bounds.
struct ItemList {
    LargeArray<Item> items;
    std::size_t count = 0, triangles = 0;  ///< number of items, and number of triangles among them
    Box box;
    CenterBounds centers;
};

/// Linear motion bounds: boxes at shutter open and close, interpolated linearly between.
struct MovingBox {
    Box open, close;

    void extend(const MovingBox& other)
    {
        open.extend(other.open);
        close.extend(other.close);
    }
    /// Box at the middle of the shutter interval, which bounds the motion at that time.
    Box middle() const;
    /// Largest absolute coordinate.
    float radius() const;
    /// Tightest motion bounds that contain boxes[i] at times[i], where times lie in [0, 1].
    static MovingBox around(const float* times, const Box* boxes, std::size_t count);
};

/// Motion bounds of one primitive. kind and id are those of an Item. mesh_boxes: indexed by shape.
MovingBox moving_box(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes,
                     std::uint32_t kind, std::uint32_t id);

/// Items of a shape's primitives [first, last) that can be hit.
ItemList shape_items(const GeometryTables& tables, const BvhData& bvh, std::uint32_t first, std::uint32_t last);
/// Items of the world: all primitives and instances; only static instances if the tables are editable. bvh.meshes and
/// mesh_boxes (indexed by shape) must be set.
ItemList world_items(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes);
/// Items of the movable instances of editable tables.
ItemList movable_items(const GeometryTables& tables, const BvhData& bvh, const std::vector<MovingBox>& mesh_boxes);

}  // namespace fathom::bvh
