#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "fathom/animation.h"

namespace fathom {

/// Adds offsets, each times its weight, to the vertices that the mesh has; weights beyond the targets don't count.
void morph(Mesh& mesh, const std::vector<MorphTarget>& targets, std::span<const float> weights);

/// Moves each vertex with its joints, by their weights, which are brought to a sum of 1; one without stays where it is.
/// Normals and tangents become unit.
///
/// joints      as many for each vertex, numbers of world_from_mesh
/// weights     as many
void bend(Mesh& mesh, std::span<const std::uint16_t> joints, std::span<const float> weights,
          const std::vector<Transform>& world_from_mesh);

}  // namespace fathom
