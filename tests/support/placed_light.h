// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "fathom/description.h"

namespace fathom::test {

/// Adds a light with a node of its own.
inline void add_light(SceneDescription& d, const Light& light, const Transform& place)
{
    Node node;
    node.parent_from_node = place;
    node.light = int(d.lights.size());
    d.lights.push_back(light);
    d.roots.push_back(int(d.nodes.size()));
    d.nodes.push_back(node);
}

}  // namespace fathom::test
