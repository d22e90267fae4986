// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "fathom/animation.h"

namespace fathom {

/// Adds the weighted offsets of morph targets to the vertex attributes that the mesh has. Weights beyond the targets
/// are ignored.
void apply_morph_targets(Mesh& mesh, const std::vector<MorphTarget>& targets, std::span<const float> weights);

/// Linear blend skinning: moves each vertex by the weighted mean of its joints' transforms. Weights are normalized to a
/// sum of 1; vertices without weights stay in place. Normals and tangents become unit.
///
/// joints   indices into world_from_mesh, as many for each vertex
/// weights  one weight for each entry of joints
void apply_skin(Mesh& mesh, std::span<const std::uint16_t> joints, std::span<const float> weights,
                const std::vector<Transform>& world_from_mesh);

}  // namespace fathom
