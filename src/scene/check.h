#pragma once
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// Throws Error, with scene.file and a place like `nodes[3].children[0]`, for what no later part could work with:
/// indices out of range, nodes that contain themselves or are nested more than 256 deep, more than 100 million shapes
/// counted over instances or more than fit into memory, per-vertex data of the wrong length, positions and transforms
/// that are not finite.
void check_scene(const SceneDescription& scene);

/// Some things of a scene, by index.
struct SceneParts {
    std::vector<int> nodes, meshes, materials, lights;
};
/// As check_scene of a scene that passed it before these parts and its environment got other values; nodes have kept
/// their children and what they place.
void check_parts(const SceneDescription& scene, const SceneParts& parts);

/// What a shape takes, at the least, in each place that instances put it.
inline constexpr double bytes_per_occurrence = 512;

/// For each node, whether a root leads to it. The scene must have passed check_scene.
std::vector<bool> reachable_nodes(const SceneDescription& scene);

}  // namespace fathom
