// SPDX-License-Identifier: Apache-2.0
#include "formats/mitsuba/sdf_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "fathom/error.h"
#include "formats/mesh/vertex_index.h"

namespace fathom::mitsuba {

namespace {

using GridPoint = std::array<int, 3>;

class Grid {
public:
    Grid(const std::string& file, std::string_view bytes)
    {
        constexpr std::size_t header = 48;
        const auto fail = [&](const std::string& message) { throw Error(file, "", message); };
        if (bytes.size() < header || bytes.substr(0, 3) != "VOL" || bytes[3] != 3)
            fail("this is not a volume file: it must begin with 'VOL' and version 3");
        std::int32_t words[5];
        std::memcpy(words, bytes.data() + 4, sizeof words);
        if (words[0] != 1) fail("its numbers are not 32-bit floats");
        if (words[4] != 1) fail(fmt::format("it has {} channels: a distance field has one", words[4]));
        std::size_t count = 1;
        for (std::size_t k = 0; k < 3; ++k) {
            size_[k] = words[k + 1];
            if (size_[k] < 2 || size_[k] > 4096)
                fail(fmt::format("{} numbers along an axis: 2 to 4096 are supported", size_[k]));
            count *= std::size_t(size_[k]);
        }
        if (bytes.size() - header != count * sizeof(float))
            fail(fmt::format("it contains {} bytes of numbers, expected {}", bytes.size() - header,
                             count * sizeof(float)));
        values_.resize(count);
        std::memcpy(values_.data(), bytes.data() + header, count * sizeof(float));
        for (const float value : values_)
            if (!std::isfinite(value)) fail("one of its numbers is not finite");
    }

    int cells(std::size_t axis) const { return size_[axis] - 1; }

    /// Distances at a cell's corners; the bits of a corner's index are x, y, z.
    std::array<double, 8> corners(const GridPoint& cell) const
    {
        std::array<double, 8> v;
        for (std::size_t i = 0; i < 8; ++i)
            v[i] = double(at(cell[0] + int(i & 1), cell[1] + int(i >> 1 & 1), cell[2] + int(i >> 2)));
        return v;
    }
    /// Gradient of a cell's trilinear interpolant in the unit cube, at a position in units of cells; the interpolant is
    /// extrapolated outside of its cell.
    Vec3d gradient(const GridPoint& cell, Vec3d p) const
    {
        const std::array<double, 8> c = corners(cell);
        const double u[] = {p.x - cell[0], p.y - cell[1], p.z - cell[2]};
        double g[3] = {};
        for (std::size_t i = 0; i < 8; ++i)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                double weight = i >> axis & 1 ? 1 : -1;
                for (std::size_t k = 0; k < 3; ++k)
                    if (k != axis) weight *= i >> k & 1 ? u[k] : 1 - u[k];
                g[axis] += c[i] * weight * cells(axis);
            }
        return {g[0], g[1], g[2]};
    }
    /// Normal from the gradients of the eight surrounding cells, interpolated by the distance from their centers.
    Vec3d smooth_normal(Vec3d p) const
    {
        const double at[] = {p.x, p.y, p.z};
        GridPoint first;
        double share[3];
        for (std::size_t k = 0; k < 3; ++k) {
            first[k] = int(std::round(at[k])) - 1;
            share[k] = at[k] - (first[k] + 0.5);
            if (first[k] < 0) share[k] = 1;
            if (first[k] + 1 >= cells(k)) share[k] = 0;
        }
        Vec3d sum;
        for (std::size_t i = 0; i < 8; ++i) {
            GridPoint cell;
            double weight = 1;
            for (std::size_t k = 0; k < 3; ++k) {
                cell[k] = std::clamp(first[k] + int(i >> k & 1), 0, cells(k) - 1);
                weight *= i >> k & 1 ? share[k] : 1 - share[k];
            }
            if (weight > 0) sum = sum + normalize(gradient(cell, p)) * weight;
        }
        return normalize(sum);
    }

private:
    float at(int x, int y, int z) const
    {
        return values_[(std::size_t(z) * std::size_t(size_[1]) + std::size_t(y)) * std::size_t(size_[0]) +
                       std::size_t(x)];
    }
    GridPoint size_{};
    std::vector<float> values_;
};

double mixed(const std::array<double, 8>& c, double x, double y, double z)
{
    const auto mix = [](double a, double b, double t) { return (1 - t) * a + t * b; };
    return mix(mix(mix(c[0], c[1], x), mix(c[2], c[3], x), y), mix(mix(c[4], c[5], x), mix(c[6], c[7], x), y), z);
}

/// Marching tetrahedra: each part of a cell is split into six tetrahedra about its diagonal, so that adjacent parts
/// share edges.
class Surface {
public:
    Surface(const Grid& grid, int parts) : grid_(grid), parts_(parts)
    {
        for (std::size_t k = 0; k < 3; ++k) nodes_[k] = std::uint64_t(grid.cells(k)) * std::uint64_t(parts) + 1;
    }
    bool fits() const { return nodes_[0] * nodes_[1] * nodes_[2] <= 0xffffffffu; }

    Mesh mesh()
    {
        GridPoint cell;
        for (cell[2] = 0; cell[2] < grid_.cells(2); ++cell[2])
            for (cell[1] = 0; cell[1] < grid_.cells(1); ++cell[1])
                for (cell[0] = 0; cell[0] < grid_.cells(0); ++cell[0]) add_cell(cell);
        return std::move(mesh_);
    }
    /// Positions of the vertices, in units of cells.
    const std::vector<Vec3d>& places() const { return places_; }

private:
    struct Node {
        GridPoint place;  ///< in parts of cells
        double value;
    };

    void add_cell(const GridPoint& cell)
    {
        corners_ = grid_.corners(cell);
        cell_ = cell;
        const auto [least, most] = std::minmax_element(corners_.begin(), corners_.end());
        if (*least >= 0 || *most < 0) return;
        for (int z = 0; z < parts_; ++z)
            for (int y = 0; y < parts_; ++y)
                for (int x = 0; x < parts_; ++x) add_piece({x, y, z});
    }
    void add_piece(const GridPoint& piece)
    {
        Node nodes[8];
        int inside = 0;
        for (std::size_t i = 0; i < 8; ++i) {
            GridPoint& p = nodes[i].place;
            double u[3];
            for (std::size_t k = 0; k < 3; ++k) {
                const int part = piece[k] + int(i >> k & 1);
                p[k] = cell_[k] * parts_ + part;
                u[k] = double(part) / parts_;
            }
            nodes[i].value = mixed(corners_, u[0], u[1], u[2]);
            inside += nodes[i].value < 0;
        }
        if (inside == 0 || inside == 8) return;
        // Paths from corner 0 to corner 7 along one axis after another.
        constexpr std::size_t ways[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
        for (const auto& way : ways) add_tetrahedron({&nodes[0], &nodes[way[0]], &nodes[way[1]], &nodes[7]});
    }
    /// corners  ascending in every coordinate
    void add_tetrahedron(const std::array<const Node*, 4>& corners)
    {
        std::vector<std::size_t> in, out;
        for (std::size_t i = 0; i < 4; ++i) (corners[i]->value < 0 ? in : out).push_back(i);
        if (in.empty() || out.empty()) return;
        const auto cut = [&](std::size_t a, std::size_t b) {
            return vertex(*corners[std::min(a, b)], *corners[std::max(a, b)]);
        };
        const Node &from = *corners[in[0]], &to = *corners[out[0]];
        const Vec3d outwards{double(to.place[0] - from.place[0]), double(to.place[1] - from.place[1]),
                             double(to.place[2] - from.place[2])};
        if (in.size() == 2) {
            const std::uint32_t a = cut(in[0], out[0]), b = cut(in[0], out[1]), c = cut(in[1], out[1]),
                                d = cut(in[1], out[0]);
            add_triangle(a, b, c, outwards), add_triangle(a, c, d, outwards);
        } else {
            const std::size_t tip = in.size() == 1 ? in[0] : out[0];
            const std::vector<std::size_t>& base = in.size() == 1 ? out : in;
            add_triangle(cut(tip, base[0]), cut(tip, base[1]), cut(tip, base[2]), outwards);
        }
    }
    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Vec3d outwards)
    {
        const auto at = [&](std::uint32_t i) {
            const Vec3f p = mesh_.positions[i];
            return Vec3d{double(p.x), double(p.y), double(p.z)};
        };
        const Vec3d normal = cross(at(b) - at(a), at(c) - at(a));
        if (length(normal) == 0) return;
        Vec3d along{outwards.x / double(nodes_[0]), outwards.y / double(nodes_[1]), outwards.z / double(nodes_[2])};
        if (dot(normal, along) < 0) std::swap(b, c);
        mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
    }
    /// The vertex where the surface intersects the edge from a to b.
    ///
    /// b  not less than a in any coordinate
    std::uint32_t vertex(const Node& a, const Node& b)
    {
        std::uint32_t direction = 0;
        std::uint64_t node = 0;
        for (std::size_t k = 3; k-- > 0;) {
            direction = 2 * direction + std::uint32_t(b.place[k] - a.place[k]);
            node = node * nodes_[k] + std::uint64_t(a.place[k]);
        }
        const std::uint32_t index = vertices_({std::uint32_t(node), direction, 0});
        if (index < mesh_.positions.size()) return index;
        const auto at = [&](double t, std::size_t k) {
            return (a.place[k] + t * (b.place[k] - a.place[k])) / parts_ - cell_[k];
        };
        double low = 0, high = 1;
        for (int step = 0; step < 24; ++step) {
            const double t = (low + high) / 2;
            const bool as_first = (mixed(corners_, at(t, 0), at(t, 1), at(t, 2)) < 0) == (a.value < 0);
            (as_first ? low : high) = t;
        }
        const double t = (low + high) / 2;
        const Vec3d p{cell_[0] + at(t, 0), cell_[1] + at(t, 1), cell_[2] + at(t, 2)};
        mesh_.positions.push_back(to_float({p.x / grid_.cells(0), p.y / grid_.cells(1), p.z / grid_.cells(2)}));
        places_.push_back(p);
        return index;
    }

    const Grid& grid_;
    const int parts_;
    std::uint64_t nodes_[3];  ///< number of nodes along each axis
    std::array<double, 8> corners_{};
    GridPoint cell_{};
    VertexIndex vertices_;
    std::vector<Vec3d> places_;
    Mesh mesh_;
};

}  // namespace

Mesh sdf_mesh(const std::string& file, std::string_view bytes, bool smooth)
{
    const Grid grid(file, bytes);
    // A resolution of about 256 parts along the longest axis is fine enough for images.
    const int most = std::max({grid.cells(0), grid.cells(1), grid.cells(2)});
    const int parts = std::clamp(256 / most, 1, 8);
    Surface surface(grid, parts);
    if (!surface.fits()) throw Error(file, "", "the grid is too large");
    Mesh mesh = surface.mesh();
    if (mesh.indices.empty()) throw Error(file, "", "it contains no surface: no cell has distances of both signs");
    // The whole surface has one texture coordinate.
    mesh.uvs[0].assign(mesh.positions.size(), {0, 0});
    if (smooth)
        for (const Vec3d& p : surface.places()) mesh.normals.push_back(to_float(grid.smooth_normal(p)));
    return mesh;
}

}  // namespace fathom::mitsuba
