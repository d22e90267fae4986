#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Where the things of one scene came to lie in another.
struct Appended {
    int first_node = 0, node_end = 0;  ///< one past the last
    int first_material = 0, material_end = 0;
    std::vector<int> roots;
};

/// Moves everything of `from` behind what `to` has and shifts the indices. The roots of `from` do not become roots of
/// `to`: the caller puts them where they belong. Environment, hints and the file's name of `to` stay.
Appended append_scene(SceneDescription& to, SceneDescription from);

/// Copies the nodes [appended.first_node, node_end) so that the copies may have other materials; meshes are shared.
Appended copy_nodes(SceneDescription& scene, const Appended& appended);

}  // namespace fathom
