#pragma once
#include <map>
#include <set>
#include <vector>

#include "compile/compiler.h"

namespace fathom {

/// A linear map that keeps angles up to rounding, and its factor.
bool is_similarity(const Transform& t, double& factor);

std::uint32_t material_index(const SceneTables& tables, const Shape& shape);

/// What several shapes of a description share: a mesh, curves, points, or the shape itself.
const void* described_content(const SceneDescription& scene, const Shape& shape);
/// What several occurrences share: the same, or a displaced mesh that stands for it.
const void* content_of(const Compiler& c, const Shape& shape);

/// What becomes an instance, in a space of its own, and what stands in the world itself.
class Instancing {
public:
    /// Materials must be there.
    Instancing(const Compiler& c, const FlattenedScene& occurrences);

    bool is_instanced(const FlattenedShape& p) const;
    /// Whether the vertices of a shape's mesh, or the control points of its curves, move while the shutter is open.
    bool vertices_move(const Shape& shape) const { return moving_.contains(described_content(c_.scene, shape)); }
    /// When vertices are given to the tree: at all keys of meshes and curves while the shutter is open.
    const std::vector<float>& vertex_times() const { return vertex_times_; }

private:
    void find_vertex_times();
    void count_uses();
    bool moves_straight(const FlattenedShape& p) const;

    const Compiler& c_;
    const FlattenedScene& occurrences_;
    std::set<const void*> moving_;  ///< meshes and curves
    std::vector<float> vertex_times_;
    std::map<const void*, std::size_t> uses_;  ///< how often meshes, curves and points are placed, by content_of
};

}  // namespace fathom
