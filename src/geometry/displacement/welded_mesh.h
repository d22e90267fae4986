// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "fathom/description.h"

namespace fathom {

/// A mesh with vertex normals in all poses. A mesh without normals gets those of its faces; then triangles share no
/// vertices.
Mesh with_normals(const Mesh& mesh);

/// Topology of a mesh by position: vertices at one position are one point, whatever their other attributes, and all
/// triangle sides between two points are one edge.
class WeldedMesh {
public:
    /// A side of an edge: two vertices of the mesh between which it runs. An edge has one side, or several along a
    /// seam; all run in the same direction.
    struct Side {
        std::uint32_t from, to, edge;
    };
    struct Edge {
        std::uint32_t first_half, first_side;
    };

    explicit WeldedMesh(const Mesh& mesh);

    // Corners are numbered as in Mesh::indices; half-edge h goes from corner h to the next corner of its triangle.
    std::size_t points() const { return first_corner_.size() - 1; }
    std::span<const std::uint32_t> corners_of(std::size_t point) const { return range(corners_, first_corner_, point); }
    std::size_t edges() const { return edges_.size() - 1; }
    std::span<const std::uint32_t> halves_of(std::size_t edge) const
    {
        const std::uint32_t first = edges_[edge].first_half;
        return std::span(halves_).subspan(first, edges_[edge + 1].first_half - first);
    }
    /// The sides of an edge are [first_side(edge), first_side(edge + 1)).
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

    std::vector<std::uint32_t> corners_, first_corner_;  ///< indexed by point, with an end marker
    std::vector<std::uint32_t> halves_;                  ///< indexed by edge
    std::vector<Edge> edges_;                            ///< has an end marker
    std::vector<Side> sides_;
    std::vector<std::uint32_t> side_of_half_;
};

}  // namespace fathom
