#pragma once
/// What goes into the trees: boxes of triangles, quads, spheres, disks and instances.
#include "geometry/bvh_data.h"
#include "geometry/bvh_split.h"

namespace fathom::bvh {

struct ItemList {
    LargeArray<Item> items;
    std::size_t count = 0, triangles = 0;  ///< items in use, and how many of them are triangles
    Box box;
    CenterBounds centers;

    /// The largest coordinate of any box.
    float radius() const;
};

/// A mesh's triangles [first, last), but those that nothing can hit.
ItemList mesh_items(const SceneTables& tables, std::uint32_t first, std::uint32_t last);
/// Everything in the world; bvh.meshes and their boxes are known.
ItemList world_items(const SceneTables& tables, const BvhData& bvh, const std::vector<Box>& mesh_boxes);

}  // namespace fathom::bvh
