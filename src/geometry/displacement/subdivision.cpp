// SPDX-License-Identifier: Apache-2.0
#include "geometry/displacement/subdivision.h"

#include <algorithm>

namespace fathom {

namespace {

/// Number of inner vertices of a triangle with this many parts along its finest edge.
std::uint64_t inner_vertices(std::uint64_t parts)
{
    return (parts - 1) * (parts - 2) / 2;
}

std::uint8_t finest(const WeldedMesh& welded, const std::vector<std::uint8_t>& exponents, std::size_t triangle)
{
    std::uint8_t most = 0;
    for (std::size_t h = 3 * triangle; h < 3 * triangle + 3; ++h) most = std::max(most, exponents[welded.edge_of(h)]);
    return most;
}

}  // namespace

Subdivision::Size Subdivision::size(const Mesh& mesh, const WeldedMesh& welded,
                                    const std::vector<std::uint8_t>& exponents)
{
    Size size;
    size.vertices = double(mesh.positions.size());
    for (const WeldedMesh::Side& side : welded.sides()) size.vertices += double((1u << exponents[side.edge]) - 1);
    for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
        // Euler's formula: a triangulation has 2 * inner + border - 2 triangles.
        const auto inner = double(inner_vertices(1u << finest(welded, exponents, t)));
        double border = 0;
        for (std::size_t h = 3 * t; h < 3 * t + 3; ++h) border += double(1u << exponents[welded.edge_of(h)]);
        size.vertices += inner;
        size.triangles += 2 * inner + border - 2;
    }
    return size;
}

Subdivision::Subdivision(const Mesh& mesh, const WeldedMesh& welded, std::vector<std::uint8_t> exponents)
    : mesh_(mesh), welded_(welded), exponents_(std::move(exponents))
{
    auto next = std::uint32_t(mesh.positions.size());
    for (const WeldedMesh::Side& side : welded.sides()) {
        first_on_side_.push_back(next);
        next += parts_of_edge(side.edge) - 1;
    }
    constexpr std::uint32_t vertices_at_once = 1u << 14;
    const std::size_t triangles = mesh.indices.size() / 3;
    first_inner_.reserve(triangles + 1);
    for (std::size_t t = 0; t < triangles; ++t) {
        first_inner_.push_back(next);
        finest_.push_back(finest(welded, exponents_, t));
        const std::uint32_t n = parts(t), step = std::max(vertices_at_once / n, 1u);
        next += std::uint32_t(inner_vertices(n));
        for (std::uint32_t row = 0; row < n; row += step)
            rows_.push_back({std::uint32_t(t), row, std::min(row + step, n)});
    }
    first_inner_.push_back(next);
}

std::uint32_t Subdivision::vertex(std::size_t triangle, std::uint32_t i, std::uint32_t j) const
{
    const std::uint32_t n = parts(triangle);
    if (j == 0) return on_edge(triangle, 0, i, n);
    if (i + j == n) return on_edge(triangle, 1, j, n);
    if (i == 0) return on_edge(triangle, 2, n - j, n);
    // Each row of the triangular grid has one vertex fewer than the previous one.
    return first_inner_[triangle] + (j - 1) * (n - 1) - j * (j - 1) / 2 + i - 1;
}

/// Returns the vertex nearest to a grid position along an edge of a triangle. Ties go to the vertex that comes first
/// around the triangle: if both ends of the third edge moved away from each other along the others, its own vertices
/// would be cut off.
std::uint32_t Subdivision::on_edge(std::size_t triangle, std::uint32_t corner, std::uint32_t place,
                                   std::uint32_t parts) const
{
    const std::size_t first = 3 * triangle, half = first + corner;
    const std::uint32_t side = welded_.side_of(half), edge = welded_.sides()[side].edge, own = parts_of_edge(edge);
    const std::uint32_t coarser = parts / own, at = (place + (coarser - 1) / 2) / coarser;
    if (at == 0) return mesh_.indices[half];
    if (at == own) return mesh_.indices[first + (corner + 1) % 3];
    const bool same_way = mesh_.indices[half] == welded_.sides()[side].from;
    return vertex_on_side(side, same_way ? at : own - at);
}

std::vector<std::uint32_t> Subdivision::triangles() const
{
    const auto each = [&](const Rows& rows, const auto& f) {
        const std::uint32_t n = parts(rows.triangle);
        for (std::uint32_t j = rows.begin; j < rows.end; ++j)
            for (std::uint32_t i = 0; i + j < n; ++i) cell(rows.triangle, i, j, n, f);
    };
    std::vector<std::size_t> first(rows_.size() + 1);
    for_each_rows([&](std::size_t k, const Rows& rows) { each(rows, [&](const auto&) { first[k + 1] += 3; }); });
    for (std::size_t k = 0; k < rows_.size(); ++k) first[k + 1] += first[k];
    std::vector<std::uint32_t> indices(first.back());
    for_each_rows([&](std::size_t k, const Rows& rows) {
        std::size_t at = first[k];
        each(rows, [&](const std::array<std::uint32_t, 3>& corner) {
            for (const std::uint32_t v : corner) indices[at++] = v;
        });
    });
    return indices;
}

}  // namespace fathom
