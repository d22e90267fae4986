// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Index ranges that the parts of an appended scene have in the scene they were appended to.
struct Appended {
    int first_node = 0, node_end = 0;  ///< node_end: one past the last
    int first_material = 0, material_end = 0;
    std::vector<int> roots;
};

/// Moves all parts of `from` to the end of `to` and shifts their indices. The roots of `from` don't become roots of
/// `to`: the caller attaches them. Environment, hints and file name of `to` are kept.
Appended append_scene(SceneDescription& to, SceneDescription from);

/// Copies the nodes [appended.first_node, node_end) so that the copies can have other materials; meshes are shared.
Appended copy_nodes(SceneDescription& scene, const Appended& appended);

}  // namespace fathom
