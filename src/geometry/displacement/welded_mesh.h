#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// A mesh in which each vertex has a normal, also while it moves: one without normals is given those of its faces, for
/// which each triangle has vertices of its own.
Mesh with_normals(const Mesh& mesh);

/// What of a mesh meets where: vertices at one place are one point, whatever else tells them apart, and an edge is what
/// two points have between them, as many triangles as may share it.
class WeldedMesh {
public:
    /// Two vertices of the mesh between which an edge runs on one side of a seam, or on both where there is none. All
    /// sides of an edge run the same way.
    struct Side {
        std::uint32_t from, to, edge;
    };
    struct Edge {
        std::uint32_t first_half, first_side;
    };

    explicit WeldedMesh(const Mesh& mesh);

    // Corners of triangles are numbered as Mesh::indices; half-edge h goes from corner h to the next of its triangle.
    std::size_t points() const { return first_corner_.size() - 1; }
    std::span<const std::uint32_t> corners_of(std::size_t point) const { return range(corners_, first_corner_, point); }
    std::size_t edges() const { return edges_.size() - 1; }
    std::span<const std::uint32_t> halves_of(std::size_t edge) const
    {
        const std::uint32_t first = edges_[edge].first_half;
        return std::span(halves_).subspan(first, edges_[edge + 1].first_half - first);
    }
    /// Numbers of the sides of an edge: [first_side(edge), first_side(edge + 1)).
    std::uint32_t first_side(std::size_t edge) const { return edges_[edge].first_side; }
    const std::vector<Side>& sides() const { return sides_; }
    std::uint32_t side_of(std::size_t half) const { return side_of_half_[half]; }
    std::uint32_t edge_of(std::size_t half) const { return sides_[side_of_half_[half]].edge; }

private:
    static std::span<const std::uint32_t> range(const std::vector<std::uint32_t>& all,
                                                const std::vector<std::uint32_t>& first, std::size_t i)
    {
        return std::span(all).subspan(first[i], first[i + 1] - first[i]);
    }
    std::vector<std::uint32_t> find_points(const Mesh& mesh);
    void find_edges(const Mesh& mesh, const std::vector<std::uint32_t>& point_of);

    std::vector<std::uint32_t> corners_, first_corner_;  ///< by point; one behind the last
    std::vector<std::uint32_t> halves_;                  ///< by edge
    std::vector<Edge> edges_;                            ///< and one behind the last
    std::vector<Side> sides_;
    std::vector<std::uint32_t> side_of_half_;
};

}  // namespace fathom
