// SPDX-License-Identifier: Apache-2.0
#include "geometry/displacement/welded_mesh.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

#include "compile/render_space.h"

namespace fathom {

namespace {

/// Normal of a triangle, with length twice its area.
Vec3d facet(const std::vector<Vec3f>& positions, const std::uint32_t* corner)
{
    const Vec3d a = to_double(positions[corner[0]]);
    return cross(to_double(positions[corner[1]]) - a, to_double(positions[corner[2]]) - a);
}

std::vector<Vec3f> facet_normals(const std::vector<Vec3f>& positions)
{
    std::vector<Vec3f> normals(positions.size());
    for (std::uint32_t i = 0; i + 2 < positions.size(); i += 3) {
        const std::array<std::uint32_t, 3> corner{i, i + 1, i + 2};
        const Vec3f n = to_float(normalize(facet(positions, corner.data())));
        for (const std::uint32_t k : corner) normals[k] = n;
    }
    return normals;
}

/// Replaces zero normals by those of the surrounding faces.
void repair_normals(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices,
                    std::vector<Vec3f>& normals)
{
    const auto has_direction = [](Vec3f n) { return length(to_double(n)) > 0; };
    if (std::all_of(normals.begin(), normals.end(), has_direction)) return;
    std::vector<Vec3d> sums(normals.size());
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        const Vec3d n = facet(positions, &indices[i]);
        for (std::size_t k = i; k < i + 3; ++k) sums[indices[k]] = sums[indices[k]] + n;
    }
    for (std::size_t v = 0; v < normals.size(); ++v)
        if (!has_direction(normals[v])) normals[v] = to_float(normalize(sums[v]));
}

/// A mesh in which triangles share no vertices.
Mesh unshared(const Mesh& mesh)
{
    Mesh out;
    const auto reindex = [&](const auto& from, auto& to) {
        if (from.empty()) return;
        to.reserve(mesh.indices.size());
        for (const std::uint32_t i : mesh.indices) to.push_back(from[i]);
    };
    reindex(mesh.positions, out.positions);
    reindex(mesh.tangents, out.tangents);
    for (std::size_t set = 0; set < 2; ++set) reindex(mesh.uvs[set], out.uvs[set]);
    reindex(mesh.colors, out.colors);
    for (const MeshKey& key : mesh.motion) {
        out.motion.push_back({key.time, {}, {}});
        reindex(key.positions, out.motion.back().positions);
    }
    out.indices.resize(mesh.indices.size());
    std::iota(out.indices.begin(), out.indices.end(), 0u);
    out.name = mesh.name;
    out.movable = mesh.movable;
    return out;
}

}  // namespace

Mesh with_normals(const Mesh& mesh)
{
    if (mesh.normals.empty()) {
        Mesh out = unshared(mesh);
        out.normals = facet_normals(out.positions);
        for (MeshKey& key : out.motion) key.normals = facet_normals(key.positions);
        return out;
    }
    Mesh out = mesh;
    repair_normals(out.positions, out.indices, out.normals);
    for (MeshKey& key : out.motion) repair_normals(key.positions, out.indices, key.normals);
    return out;
}

WeldedMesh::WeldedMesh(const Mesh& mesh)
{
    find_edges(mesh, find_points(mesh));
}

/// Numbers the distinct positions of vertices, independently of the order of vertices.
std::vector<std::uint32_t> WeldedMesh::find_points(const Mesh& mesh)
{
    const std::vector<Vec3f>& p = mesh.motion.empty() ? mesh.positions : mesh.motion.front().positions;
    const auto place = [&](std::uint32_t v) { return std::tuple(p[v].x, p[v].y, p[v].z); };
    std::vector<std::uint32_t> order(p.size());
    std::iota(order.begin(), order.end(), 0u);
    tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple(place(a), a) < std::tuple(place(b), b);
    });
    std::vector<std::uint32_t> point_of(p.size());
    std::uint32_t points = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && place(order[i]) != place(order[i - 1])) ++points;
        point_of[order[i]] = points;
    }
    if (!order.empty()) ++points;
    first_corner_.assign(points + 1, 0);
    for (const std::uint32_t v : mesh.indices) ++first_corner_[point_of[v] + 1];
    std::partial_sum(first_corner_.begin(), first_corner_.end(), first_corner_.begin());
    corners_.resize(mesh.indices.size());
    std::vector<std::uint32_t> next(first_corner_.begin(), first_corner_.end() - 1);
    for (std::uint32_t c = 0; c < mesh.indices.size(); ++c) corners_[next[point_of[mesh.indices[c]]]++] = c;
    return point_of;
}

void WeldedMesh::find_edges(const Mesh& mesh, const std::vector<std::uint32_t>& point_of)
{
    struct Half {
        std::uint32_t point[2], vertex[2], number;

        auto edge() const { return std::tuple(point[0], point[1]); }
        auto side() const { return std::tuple(point[0], point[1], vertex[0], vertex[1]); }
    };
    std::vector<Half> halves(mesh.indices.size());
    for (std::uint32_t i = 0; i < halves.size(); ++i) {
        std::uint32_t a = mesh.indices[i], b = mesh.indices[i % 3 == 2 ? i - 2 : i + 1];
        if (std::tuple(point_of[b], b) < std::tuple(point_of[a], a)) std::swap(a, b);
        halves[i] = {{point_of[a], point_of[b]}, {a, b}, i};
    }
    tbb::parallel_sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
        return std::tuple(a.side(), a.number) < std::tuple(b.side(), b.number);
    });
    halves_.resize(halves.size());
    side_of_half_.resize(halves.size());
    for (std::uint32_t i = 0; i < halves.size(); ++i) {
        const Half& half = halves[i];
        const bool new_edge = i == 0 || half.edge() != halves[i - 1].edge();
        if (new_edge) edges_.push_back({i, std::uint32_t(sides_.size())});
        if (new_edge || half.side() != halves[i - 1].side())
            sides_.push_back({half.vertex[0], half.vertex[1], std::uint32_t(edges_.size() - 1)});
        halves_[i] = half.number;
        side_of_half_[half.number] = std::uint32_t(sides_.size() - 1);
    }
    edges_.push_back({std::uint32_t(halves.size()), std::uint32_t(sides_.size())});
}

}  // namespace fathom
