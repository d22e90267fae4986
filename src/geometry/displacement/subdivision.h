// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <tbb/parallel_for.h>

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/displacement/welded_mesh.h"

namespace fathom {

/// A vertex of a subdivided mesh as a weighted sum of vertices of the original mesh.
struct Blend {
    std::array<std::uint32_t, 3> vertex;
    std::array<double, 3> weight;
};

/// Subdivision of a mesh: each edge is cut into equal parts, a power of two of them. Edges between equal points are cut
/// alike, which prevents cracks.
///
/// A triangle becomes a grid with as many parts per side as its finest edge has. Along coarser edges the grid's
/// vertices snap to the nearest vertex of the edge, and triangles that become degenerate are omitted. The order of
/// vertices is: those of the mesh, those inside sides of edges, those inside triangles.
class Subdivision {
public:
    static constexpr unsigned max_exponent = 15;
    /// exponents: by edge, the binary logarithm of its number of parts.
    Subdivision(const Mesh& mesh, const WeldedMesh& welded, std::vector<std::uint8_t> exponents);

    /// Number of triangles and vertices of the result.
    struct Size {
        double triangles = 0, vertices = 0;
    };
    /// Computes the size of a subdivision without creating it.
    static Size size(const Mesh& mesh, const WeldedMesh& welded, const std::vector<std::uint8_t>& exponents);

    std::uint32_t vertices() const { return first_inner_.back(); }
    /// The first vertex inside a triangle; vertices before it may be shared.
    std::uint32_t first_inner_vertex() const { return first_inner_.front(); }
    std::uint32_t parts_of_edge(std::size_t edge) const { return 1u << exponents_[edge]; }
    /// The j-th vertex inside a side, from 1 on.
    std::uint32_t vertex_on_side(std::uint32_t side, std::uint32_t j) const { return first_on_side_[side] + j - 1; }
    /// Number of grid parts per side of a triangle.
    std::uint32_t parts(std::size_t triangle) const { return 1u << finest_[triangle]; }
    /// The grid vertex (i, j): i toward the second corner, j toward the third; i + j <= parts.
    std::uint32_t vertex(std::size_t triangle, std::uint32_t i, std::uint32_t j) const;

    /// Calls f(vertex, Blend) for each vertex, in parallel.
    template <class F>
    void for_each_vertex(const F& f) const;
    /// Calls f(triangle, i, j) for each vertex inside a triangle, in parallel.
    template <class F>
    void for_each_inner(const F& f) const;
    /// Calls f({a, b, c}) for the small triangles with a vertex on an edge, in a fixed order.
    template <class F>
    void for_each_border_triangle(std::size_t triangle, const F& f) const;
    /// Vertex indices of all triangles.
    std::vector<std::uint32_t> triangles() const;

private:
    /// A range of rows of a triangle's grid, which is a unit of parallel work.
    struct Rows {
        std::uint32_t triangle, begin, end;
    };

    std::uint32_t on_edge(std::size_t triangle, std::uint32_t corner, std::uint32_t place, std::uint32_t parts) const;
    template <class F>
    void cell(std::size_t triangle, std::uint32_t i, std::uint32_t j, std::uint32_t parts, const F& f) const;
    template <class F>
    void for_each_rows(const F& f) const
    {
        tbb::parallel_for(std::size_t(0), rows_.size(), [&](std::size_t k) { f(k, rows_[k]); });
    }

    const Mesh& mesh_;
    const WeldedMesh& welded_;
    std::vector<std::uint8_t> exponents_;  ///< indexed by edge
    std::vector<std::uint8_t> finest_;     ///< indexed by triangle: the largest exponent of its edges
    std::vector<std::uint32_t> first_on_side_;
    std::vector<std::uint32_t> first_inner_;  ///< indexed by triangle, with an end marker
    std::vector<Rows> rows_;
};

template <class F>
void Subdivision::for_each_inner(const F& f) const
{
    for_each_rows([&](std::size_t, const Rows& rows) {
        const std::uint32_t n = parts(rows.triangle);
        for (std::uint32_t j = std::max(rows.begin, 1u); j < rows.end; ++j)
            for (std::uint32_t i = 1; i + j < n; ++i) f(std::size_t(rows.triangle), i, j);
    });
}

template <class F>
void Subdivision::for_each_vertex(const F& f) const
{
    const auto own = std::uint32_t(mesh_.positions.size());
    tbb::parallel_for(0u, own, [&](std::uint32_t v) { f(v, Blend{{v, v, v}, {1, 0, 0}}); });
    const auto& sides = welded_.sides();
    tbb::parallel_for(std::size_t(0), sides.size(), [&](std::size_t s) {
        const std::uint32_t n = parts_of_edge(sides[s].edge);
        for (std::uint32_t j = 1; j < n; ++j) {
            const double share = double(j) / n;
            f(vertex_on_side(std::uint32_t(s), j),
              Blend{{sides[s].from, sides[s].to, sides[s].to}, {1 - share, share, 0}});
        }
    });
    for_each_inner([&](std::size_t triangle, std::uint32_t i, std::uint32_t j) {
        const double n = parts(triangle), u = i / n, v = j / n;
        const std::uint32_t* corner = &mesh_.indices[3 * triangle];
        f(vertex(triangle, i, j), Blend{{corner[0], corner[1], corner[2]}, {1 - u - v, u, v}});
    });
}

/// The two triangles of a grid cell; those that snapping made degenerate are omitted.
template <class F>
void Subdivision::cell(std::size_t triangle, std::uint32_t i, std::uint32_t j, std::uint32_t parts, const F& f) const
{
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (a != b && b != c && c != a) f(std::array<std::uint32_t, 3>{a, b, c});
    };
    const std::uint32_t right = vertex(triangle, i + 1, j), above = vertex(triangle, i, j + 1);
    add(vertex(triangle, i, j), right, above);
    if (i + j + 1 < parts) add(right, vertex(triangle, i + 1, j + 1), above);
}

template <class F>
void Subdivision::for_each_border_triangle(std::size_t triangle, const F& f) const
{
    const std::uint32_t n = parts(triangle);
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i + j < n; ++i) {
            cell(triangle, i, j, n, f);
            // Cells in the middle of a row touch no edge of the triangle and are skipped.
            if (j > 0 && i == 0 && n - j > 4) i = n - j - 4;
        }
}

}  // namespace fathom
