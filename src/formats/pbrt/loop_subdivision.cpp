// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "formats/pbrt/loop_subdivision.h"

namespace fathom::pbrt {

namespace {

Vec3f operator+(Vec3f a, Vec3f b)
{
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec3f operator*(Vec3f a, double s)
{
    const auto f = float(s);
    return {a.x * f, a.y * f, a.z * f};
}

using Edge = std::array<std::uint32_t, 2>;

Edge edge_of(std::uint32_t a, std::uint32_t b)
{
    return {std::min(a, b), std::max(a, b)};
}

/// Adjacency of vertices.
struct Neighbors {
    std::map<Edge, std::vector<std::uint32_t>> opposite;  ///< for each edge, the opposite corners of its faces
    std::vector<Vec3f> ring_sum, rim_sum;                 ///< sums of the positions of all neighbors, and of neighbors
                                                          ///< along the boundary
    std::vector<int> valence, rim;

    Neighbors(const std::vector<Vec3f>& p, const std::vector<std::uint32_t>& indices)
        : ring_sum(p.size()), rim_sum(p.size()), valence(p.size()), rim(p.size())
    {
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
            for (std::size_t k = 0; k < 3; ++k)
                opposite[edge_of(indices[i + k], indices[i + (k + 1) % 3])].push_back(indices[i + (k + 2) % 3]);
        for (const auto& [edge, corners] : opposite)
            for (std::size_t k = 0; k < 2; ++k) {
                const std::uint32_t at = edge[k], other = edge[1 - k];
                ring_sum[at] = ring_sum[at] + p[other];
                ++valence[at];
                if (corners.size() != 1) continue;
                rim_sum[at] = rim_sum[at] + p[other];
                ++rim[at];
            }
    }
};

/// A vertex averaged with its neighbors, each with the given weight.
Vec3f weighted(const Neighbors& n, const std::vector<Vec3f>& p, std::size_t i, double beta, double rim_beta)
{
    if (n.rim[i] == 2) return p[i] * (1 - 2 * rim_beta) + n.rim_sum[i] * rim_beta;
    if (n.rim[i] != 0 || n.valence[i] == 0) return p[i];
    return p[i] * (1 - n.valence[i] * beta) + n.ring_sum[i] * beta;
}

double beta_of(int valence)
{
    return valence == 3 ? 3.0 / 16 : 3.0 / (8.0 * std::max(1, valence));
}

void subdivide(std::vector<Vec3f>& p, std::vector<std::uint32_t>& indices)
{
    const Neighbors n(p, indices);
    std::vector<Vec3f> moved;
    moved.reserve(p.size() + n.opposite.size());
    for (std::size_t i = 0; i < p.size(); ++i) moved.push_back(weighted(n, p, i, beta_of(n.valence[i]), 1.0 / 8));
    std::map<Edge, std::uint32_t> middle;
    for (const auto& [edge, corners] : n.opposite) {
        middle[edge] = std::uint32_t(moved.size());
        const Vec3f ends = p[edge[0]] + p[edge[1]];
        moved.push_back(corners.size() == 2 ? ends * 0.375 + (p[corners[0]] + p[corners[1]]) * 0.125 : ends * 0.5);
    }
    std::vector<std::uint32_t> finer;
    finer.reserve(indices.size() * 4);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
        const std::uint32_t ab = middle[edge_of(a, b)], bc = middle[edge_of(b, c)], ca = middle[edge_of(c, a)];
        for (std::uint32_t corner : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) finer.push_back(corner);
    }
    p = std::move(moved), indices = std::move(finer);
}

}  // namespace

Mesh loop_subdivided(const std::vector<Vec3f>& positions, const std::vector<std::uint32_t>& indices, int levels)
{
    Mesh mesh;
    mesh.positions = positions, mesh.indices = indices;
    for (int level = 0; level < levels; ++level) subdivide(mesh.positions, mesh.indices);
    const Neighbors n(mesh.positions, mesh.indices);
    std::vector<Vec3f> limit;
    limit.reserve(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const double beta = beta_of(n.valence[i]);
        limit.push_back(weighted(n, mesh.positions, i, 1 / (n.valence[i] + 3 / (8 * beta)), 1.0 / 5));
    }
    mesh.positions = std::move(limit);
    return mesh;
}

}  // namespace fathom::pbrt
