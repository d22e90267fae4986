// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <set>
#include <vector>

#include "compile/compiler.h"

namespace fathom {

/// Whether a linear map preserves angles up to rounding; factor: its scale.
bool is_similarity(const Transform& t, double& factor);

/// Index of a shape's material in the tables; shapes without one use the default material, which is the last.
std::uint32_t material_index(const SceneTables& tables, const Shape& shape);

/// The content that several shapes of a description may share: a mesh, curves, points, or the shape itself.
const void* described_geometry(const SceneDescription& scene, const Shape& shape);
/// The content that several occurrences may share: described_geometry(), or the displaced mesh that replaces it.
const void* shared_geometry(const Compiler& c, const Shape& shape);

/// Decides which occurrences become instances with an object space of their own, and which become primitives of the
/// world.
class Instancing {
public:
    /// The materials of `c.tables` must be compiled.
    Instancing(const Compiler& c, const FlattenedScene& occurrences);

    /// Whether an occurrence becomes an instance: it moves, may move later, shares much geometry with others, or
    /// distorts curves or points.
    bool is_instanced(const FlattenedShape& p) const;
    /// Whether the vertices of a shape's mesh, or the control points of its curves, move during the shutter interval.
    bool vertices_move(const Shape& shape) const { return moving_.contains(described_geometry(c_.scene, shape)); }
    /// Times at which moving vertices are stored: all keys of meshes and curves within the shutter interval, and its
    /// ends.
    const std::vector<float>& vertex_times() const { return vertex_times_; }

private:
    void find_vertex_times();
    void count_uses();
    bool moves_straight(const FlattenedShape& p) const;

    const Compiler& c_;
    const FlattenedScene& occurrences_;
    std::set<const void*> moving_;  ///< meshes and curves whose vertices or control points move
    std::vector<float> vertex_times_;
    std::map<const void*, std::size_t>
        uses_;  ///< number of occurrences of meshes, curves and points, by shared_geometry()
};

}  // namespace fathom
