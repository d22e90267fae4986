// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "fathom/description/geometry.h"
#include "fathom/vector.h"

namespace fathom {

/// Transform of a node at one time.
struct NodeKey {
    double time = 0;             ///< Time of the key in seconds.
    Transform parent_from_node;  ///< Invertible transform; all keys of a node mirror, or none does.
};

/// An object with a transform that places shapes, a light, a camera and other nodes. A node that is the child of
/// several nodes is an instance in each of them. Nodes may be nested 256 deep, without cycles.
struct Node {
    std::string name;            ///< Name for messages; may be empty.
    Transform parent_from_node;  ///< Transform of a node that doesn't move; ignored if there is motion.
    /// Empty, or at least two keys in ascending order of time. Each is decomposed into stretch, rotation and
    /// translation (Higham 1986, polar decomposition). Between keys, stretch and translation change linearly, and the
    /// rotation turns at constant speed the shorter way. Before the first key and after the last one the node doesn't
    /// move. Cameras and directional lights don't move with a node: they are placed where it is when the shutter opens.
    std::vector<NodeKey> motion;
    std::vector<int> children;    ///< Nodes placed in the space of this node.
    std::vector<Shape> shapes;    ///< Geometry in the space of this node.
    int light = -1, camera = -1;  ///< Light and camera in the space of this node; -1: none.
    bool movable = false;         ///< The node and its children will move between images; see EditableScene.
};

}  // namespace fathom
