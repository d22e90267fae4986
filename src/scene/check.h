// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Throws Error, with scene.file and a place such as `nodes[3].children[0]`, for scenes that later stages can't handle:
/// - indices out of range, and nodes that contain themselves or are nested more than 256 levels deep
/// - more than 100 million shapes counted over instances, or more than fit into memory
/// - per-vertex data of the wrong length
/// - positions and transforms that are not finite
void check_scene(const SceneDescription& scene);

/// Indices of the changed parts of a scene.
struct SceneParts {
    std::vector<int> nodes, meshes, materials, lights;
};
/// Checks parts that changed since the scene passed check_scene, and the environment. Nodes must have kept their
/// children and contents.
void check_parts(const SceneDescription& scene, const SceneParts& parts);

/// Lower bound of the memory in bytes that each instanced occurrence of a shape takes.
inline constexpr double bytes_per_occurrence = 512;

/// For each node, whether it is reachable from a root. The scene must have passed check_scene.
std::vector<bool> reachable_nodes(const SceneDescription& scene);

}  // namespace fathom
