#pragma once
#include <map>
#include <vector>

#include "compile/compiler.h"

namespace fathom {

/// A linear map that keeps angles up to rounding, and its factor.
bool is_similarity(const Transform& t, double& factor);

std::uint32_t material_index(const SceneTables& tables, const Shape& shape);

/// What several occurrences share: a mesh, curves, points, or the shape itself.
const void* content_of(const SceneDescription& scene, const Shape& shape);

/// What becomes an instance, in a space of its own, and what stands in the world itself.
class Instancing {
public:
    /// Materials must be there.
    Instancing(const Compiler& c, const Occurrences& occurrences);

    bool is_instanced(const ShapeOccurrence& p) const;
    /// Whether the vertices of a mesh move while the shutter is open. mesh: an index, or beyond.
    bool mesh_moves(std::size_t mesh) const { return mesh < mesh_moves_.size() && mesh_moves_[mesh]; }
    /// When vertices are given to the tree: at all keys of meshes while the shutter is open.
    const std::vector<float>& vertex_times() const { return vertex_times_; }

private:
    const Mesh& mesh_of(MeshInstance m) const { return c_.scene.meshes[std::size_t(m.mesh)]; }
    void find_vertex_times();
    void count_uses();
    bool moves_straight(const ShapeOccurrence& p) const;

    const Compiler& c_;
    const Occurrences& occurrences_;
    std::vector<bool> mesh_moves_;
    std::vector<float> vertex_times_;
    std::vector<int> uses_;                ///< of meshes that are placed often enough to be worth instances; else 0
    std::map<const void*, int> set_uses_;  ///< how often curves and points are placed
};

}  // namespace fathom
