// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Motion BVHs: built for the middle of the shutter interval, then given linear motion bounds.
#include <vector>

#include "geometry/bvh/builder/items.h"
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// Whether the shutter interval is not empty.
bool shutter_takes_time(const GeometryTables& tables);

/// Gives the nodes from `first` on, which form one tree, linear motion bounds. Nodes whose contents move take two
/// slots. root: reference to the tree's root, updated. box: bounding box of the tree at the middle of the shutter
/// interval. Returns the tree's motion bounds.
MovingBox add_motion(const GeometryTables& tables, BvhData& bvh, const std::vector<MovingBox>& mesh_boxes,
                     std::size_t first, std::uint32_t& root, const Box& box);

/// Sets the motion bounds of child i of a node. change: the slot after the node. Returns whether the box moves.
bool set_motion(BvhNode& node, BvhNode& change, int i, const MovingBox& box);

}  // namespace fathom::bvh
