#pragma once
/// Trees over what moves: built as it is when half of the shutter's time is over, then given boxes that move.
#include <vector>

#include "geometry/bvh/builder/items.h"
#include "geometry/bvh/layout/data.h"

namespace fathom::bvh {

/// Whether there is any time between the shutter's opening and its closing.
bool shutter_takes_time(const GeometryTables& tables);

/// Gives the nodes [first, end) of one tree boxes that move where what is in them does, and doubles those nodes.
///
/// root  of the tree; changed to what it then is
/// box   where the whole tree is at half of the time; returned with its motion
MovingBox add_motion(const GeometryTables& tables, BvhData& bvh, const std::vector<MovingBox>& mesh_boxes,
                     std::size_t first, std::uint32_t& root, const Box& box);

/// Gives slot i of a node a box that moves. change: the node behind it. Whether the box does move.
bool set_motion(BvhNode& node, BvhNode& change, int i, const MovingBox& box);

}  // namespace fathom::bvh
