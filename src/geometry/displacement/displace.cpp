// SPDX-License-Identifier: Apache-2.0
#include "geometry/displacement/displace.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "compile/render_space.h"
#include "fathom/error.h"
#include "fathom/memory.h"
#include "geometry/displacement/subdivision.h"
#include "geometry/displacement/welded_mesh.h"

namespace fathom {

namespace {

/// Returns the binary logarithm of the number of parts of an edge: at least `parts`, or about that many.
std::uint8_t exponent_of(double parts, bool about)
{
    const double least = about ? parts / std::sqrt(2.0) : parts;
    std::uint8_t exponent = 0;
    while (exponent < Subdivision::max_exponent && double(1u << exponent) < least) ++exponent;
    return exponent;
}

/// Returns the binary logarithm of the number of parts of each edge. wanted: receives the number of triangles before
/// any limit.
std::vector<std::uint8_t> find_exponents(const Mesh& mesh, const WeldedMesh& welded, const Displacement& by,
                                         double& wanted)
{
    std::vector<std::uint8_t> exponents(welded.edges());
    tbb::parallel_for(std::size_t(0), exponents.size(), [&](std::size_t e) {
        for (std::uint32_t s = welded.first_side(e); s < welded.first_side(e + 1); ++s) {
            const double parts = by.parts(mesh, welded.sides()[s].from, welded.sides()[s].to);
            exponents[e] = std::max(exponents[e], exponent_of(parts, by.may_be_coarser));
        }
    });
    wanted = Subdivision::size(mesh, welded, exponents).triangles;
    const std::size_t uncut = mesh.indices.size() / 3;
    for (double count = wanted; by.may_be_coarser && count > std::max(max_displaced_triangles, double(uncut));
         count = Subdivision::size(mesh, welded, exponents).triangles)
        for (std::uint8_t& exponent : exponents) exponent -= exponent > 0;
    return exponents;
}

void check_size(const Mesh& mesh, Subdivision::Size size, const std::string& file, const std::string& name)
{
    constexpr double most = 1 << 30;
    if (size.triangles > most)
        throw Error(file, name,
                    fmt::format("displacement needs {:.0f} million triangles; up to {:.0f} million are supported: use "
                                "a larger displacement_edge_length",
                                size.triangles / 1e6, most / 1e6));
    // The estimate covers positions and normals before and after, heights, directions, and the resulting mesh.
    const double bytes = size.triangles * 12 + size.vertices * (24.0 * double(2 + mesh.motion.size()) + 64);
    if (bytes > double(available_memory_bytes()))
        throw Error(file, name,
                    fmt::format("displacement makes {:.1f} million triangles, which need {:.1f} GB of memory, {}: use "
                                "a larger displacement_edge_length",
                                size.triangles / 1e6, bytes / 1e9, available_memory_text()));
}

Vec3f blend(const std::vector<Vec3f>& of, const Blend& b)
{
    Vec3d sum;
    for (std::size_t k = 0; k < 3; ++k) sum = sum + to_double(of[b.vertex[k]]) * b.weight[k];
    return to_float(sum);
}
Vec2f blend(const std::vector<Vec2f>& of, const Blend& b)
{
    double x = 0, y = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        x += double(of[b.vertex[k]].x) * b.weight[k];
        y += double(of[b.vertex[k]].y) * b.weight[k];
    }
    return {float(x), float(y)};
}
Vec4f blend(const std::vector<Vec4f>& of, const Blend& b)
{
    double sum[4] = {};
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec4f& v = of[b.vertex[k]];
        sum[0] += double(v.x) * b.weight[k], sum[1] += double(v.y) * b.weight[k];
        sum[2] += double(v.z) * b.weight[k], sum[3] += double(v.w) * b.weight[k];
    }
    return {float(sum[0]), float(sum[1]), float(sum[2]), float(sum[3])};
}

/// The subdivided mesh before displacement.
Mesh refine(const Mesh& mesh, const Subdivision& cut)
{
    Mesh fine;
    fine.name = mesh.name;
    fine.movable = mesh.movable;
    const std::size_t n = cut.vertices();
    const auto same_size = [n](const auto& from, auto& to) { to.resize(from.empty() ? 0 : n); };
    same_size(mesh.positions, fine.positions), same_size(mesh.normals, fine.normals);
    same_size(mesh.tangents, fine.tangents), same_size(mesh.colors, fine.colors);
    for (std::size_t set = 0; set < 2; ++set) same_size(mesh.uvs[set], fine.uvs[set]);
    for (const MeshKey& key : mesh.motion)
        fine.motion.push_back({key.time, std::vector<Vec3f>(n), std::vector<Vec3f>(n)});
    const auto unit = [](Vec3f v) { return to_float(normalize(to_double(v))); };
    cut.for_each_vertex([&](std::uint32_t v, const Blend& b) {
        fine.positions[v] = blend(mesh.positions, b);
        fine.normals[v] = unit(blend(mesh.normals, b));
        if (!fine.tangents.empty()) {
            fine.tangents[v] = blend(mesh.tangents, b);
            fine.tangents[v].w = mesh.tangents[b.vertex[0]].w;
        }
        if (!fine.colors.empty()) fine.colors[v] = blend(mesh.colors, b);
        for (std::size_t set = 0; set < 2; ++set)
            if (!fine.uvs[set].empty()) fine.uvs[set][v] = blend(mesh.uvs[set], b);
        for (std::size_t k = 0; k < fine.motion.size(); ++k) {
            fine.motion[k].positions[v] = blend(mesh.motion[k].positions, b);
            fine.motion[k].normals[v] = unit(blend(mesh.motion[k].normals, b));
        }
    });
    fine.indices = cut.triangles();
    return fine;
}

/// Angles of triangles at their corners; 0 for degenerate triangles. Means over the corners at a point are weighted by
/// angle (Thuermer and Wuethrich 1998, "Computing Vertex Normals from Polygonal Facets"), so that they do not depend on
/// the triangulation of faces.
std::vector<double> corner_angles(const Mesh& mesh)
{
    std::vector<double> angles(mesh.indices.size());
    tbb::parallel_for(std::size_t(0), angles.size() / 3, [&](std::size_t t) {
        Vec3d p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = to_double(mesh.positions[mesh.indices[3 * t + k]]);
        if (!(length(cross(p[1] - p[0], p[2] - p[0])) > 0)) return;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d a = normalize(p[(k + 1) % 3] - p[k]), b = normalize(p[(k + 2) % 3] - p[k]);
            angles[3 * t + k] = std::acos(std::clamp(dot(a, b), -1.0, 1.0));
        }
    });
    return angles;
}

/// Rotates v by the smallest rotation that takes the unit vector a to the unit vector b.
Vec3d rotated(Vec3d v, Vec3d a, Vec3d b)
{
    const double c = dot(a, b);
    const Vec3d axis = cross(a, b);
    if (c < -0.999999) return -v;
    return v * c + cross(axis, v) + axis * (dot(axis, v) / (1 + c));
}

class Displacer {
public:
    Displacer(const Mesh& mesh, const WeldedMesh& welded, const Subdivision& cut)
        : mesh_(mesh), welded_(welded), cut_(cut), angles_(corner_angles(mesh))
    {
        group_smooth_vertices();
    }

    Mesh run(const Displacement& by)
    {
        Mesh fine = refine(mesh_, cut_);
        find_heights(fine, by);
        move(mesh_.positions, fine.positions, fine.normals, &fine.tangents);
        for (std::size_t k = 0; k < fine.motion.size(); ++k)
            move(mesh_.motion[k].positions, fine.motion[k].positions, fine.motion[k].normals, nullptr);
        return fine;
    }

private:
    /// Calls f(members) in parallel for each position that several vertices may share. members(g) calls g(vertex,
    /// weight) for each of them, in a fixed order.
    template <class F>
    void for_each_place(const F& f) const
    {
        tbb::parallel_for(std::size_t(0), welded_.points(), [&](std::size_t p) {
            f([&](const auto& g) {
                for (const std::uint32_t c : welded_.corners_of(p)) g(mesh_.indices[c], angles_[c]);
            });
        });
        tbb::parallel_for(std::size_t(0), welded_.edges(), [&](std::size_t e) {
            for (std::uint32_t j = 1; j < cut_.parts_of_edge(e); ++j)
                f([&](const auto& g) {
                    for (const std::uint32_t h : welded_.halves_of(e))
                        g(cut_.vertex_on_side(welded_.side_of(h), j), 1.0);
                });
        });
    }

    void find_heights(const Mesh& fine, const Displacement& by)
    {
        heights_.resize(fine.positions.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, heights_.size(), 1024), [&](const auto& range) {
            by.heights(fine, range.begin(), range.end(), &heights_[range.begin()]);
        });
        for_each_place([&](const auto& members) {
            double sum = 0, weights = 0;
            members([&](std::uint32_t v, double weight) { sum += double(heights_[v]) * weight, weights += weight; });
            if (!(weights > 0)) return;
            members([&](std::uint32_t v, double) { heights_[v] = float(sum / weights); });
        });
    }

    /// Groups vertices at one position whose normals agree: their common normal derives from all faces around them.
    void group_smooth_vertices()
    {
        constexpr double agree = 0.999;
        smooth_.resize(cut_.first_inner_vertex());
        std::iota(smooth_.begin(), smooth_.end(), 0u);
        tbb::parallel_for(std::size_t(0), welded_.points(), [&](std::size_t p) {
            std::vector<std::uint32_t> kinds;
            for (const std::uint32_t c : welded_.corners_of(p)) {
                const std::uint32_t v = mesh_.indices[c];
                const Vec3d n = normalize(to_double(mesh_.normals[v]));
                const auto same = std::find_if(kinds.begin(), kinds.end(), [&](std::uint32_t k) {
                    return k == v || dot(normalize(to_double(mesh_.normals[k])), n) >= agree;
                });
                if (same != kinds.end())
                    smooth_[v] = *same;
                else
                    kinds.push_back(v);
            }
        });
        const auto& sides = welded_.sides();
        tbb::parallel_for(std::size_t(0), welded_.edges(), [&](std::size_t e) {
            for (std::uint32_t s = welded_.first_side(e); s < welded_.first_side(e + 1); ++s) {
                std::uint32_t first = welded_.first_side(e);
                while (smooth_[sides[first].from] != smooth_[sides[s].from] ||
                       smooth_[sides[first].to] != smooth_[sides[s].to])
                    ++first;
                for (std::uint32_t j = 1; j < cut_.parts_of_edge(e); ++j)
                    smooth_[cut_.vertex_on_side(s, j)] = cut_.vertex_on_side(first, j);
            }
        });
    }

    /// Displaces one pose. coarse: positions of the original vertices in that pose.
    void move(const std::vector<Vec3f>& coarse, std::vector<Vec3f>& positions, std::vector<Vec3f>& normals,
              std::vector<Vec4f>* tangents) const
    {
        std::vector<Vec3f> moved(positions.size()), directions = normals;
        for_each_place([&](const auto& members) {
            Vec3d sum;
            members([&](std::uint32_t v, double weight) { sum = sum + to_double(normals[v]) * weight; });
            const Vec3f mean = to_float(normalize(sum));
            members([&](std::uint32_t v, double) { directions[v] = mean; });
        });
        tbb::parallel_for(std::size_t(0), positions.size(), [&](std::size_t v) {
            moved[v] = to_float(to_double(positions[v]) + to_double(directions[v]) * double(heights_[v]));
        });
        const auto turn = [&](std::size_t v, Vec3d before, Vec3d after) {
            if (!(length(before) > 0 && length(after) > 0)) return;
            before = normalize(before), after = normalize(after);
            normals[v] = to_float(normalize(rotated(to_double(normals[v]), before, after)));
            if (!tangents || tangents->empty()) return;
            Vec4f& t = (*tangents)[v];
            const Vec3f d = to_float(rotated({t.x, t.y, t.z}, before, after));
            t = {d.x, d.y, d.z, t.w};
        };
        turn_borders(positions, moved, turn);
        turn_inner(coarse, moved, turn);
        positions = std::move(moved);
    }

    template <class Turn>
    void turn_borders(const std::vector<Vec3f>& positions, const std::vector<Vec3f>& moved, const Turn& turn) const
    {
        const std::uint32_t borders = cut_.first_inner_vertex();
        std::vector<Vec3d> before(borders), after(borders);
        const auto facet = [](const std::vector<Vec3f>& p, const std::array<std::uint32_t, 3>& v) {
            const Vec3d a = to_double(p[v[0]]);
            return cross(to_double(p[v[1]]) - a, to_double(p[v[2]]) - a);
        };
        for (std::size_t t = 0; t < mesh_.indices.size() / 3; ++t)
            cut_.for_each_border_triangle(t, [&](const std::array<std::uint32_t, 3>& corner) {
                const Vec3d was = facet(positions, corner), is = facet(moved, corner);
                for (const std::uint32_t v : corner) {
                    if (v >= borders) continue;
                    before[smooth_[v]] = before[smooth_[v]] + was;
                    after[smooth_[v]] = after[smooth_[v]] + is;
                }
            });
        tbb::parallel_for(0u, borders, [&](std::uint32_t v) { turn(v, before[smooth_[v]], after[smooth_[v]]); });
    }

    /// Rotates the normals of vertices inside a triangle, which was flat.
    template <class Turn>
    void turn_inner(const std::vector<Vec3f>& coarse, const std::vector<Vec3f>& moved, const Turn& turn) const
    {
        cut_.for_each_inner([&](std::size_t t, std::uint32_t i, std::uint32_t j) {
            const std::uint32_t* corner = &mesh_.indices[3 * t];
            const Vec3d a = to_double(coarse[corner[0]]);
            const Vec3d was = cross(to_double(coarse[corner[1]]) - a, to_double(coarse[corner[2]]) - a);
            const std::uint32_t v = cut_.vertex(t, i, j);
            const Vec3d p = to_double(moved[v]);
            const std::uint32_t around[] = {cut_.vertex(t, i + 1, j),     cut_.vertex(t, i, j + 1),
                                            cut_.vertex(t, i - 1, j + 1), cut_.vertex(t, i - 1, j),
                                            cut_.vertex(t, i, j - 1),     cut_.vertex(t, i + 1, j - 1)};
            Vec3d is, last = to_double(moved[around[5]]) - p;
            for (const std::uint32_t n : around) {
                const Vec3d next = to_double(moved[n]) - p;
                is = is + cross(last, next);
                last = next;
            }
            turn(v, was, is);
        });
    }

    const Mesh& mesh_;
    const WeldedMesh& welded_;
    const Subdivision& cut_;
    std::vector<double> angles_;
    std::vector<float> heights_;
    std::vector<std::uint32_t> smooth_;  ///< for vertices on edges: the representative of its group of smooth vertices
};

}  // namespace

Displaced displace(const Mesh& source, const Displacement& by, const std::string& file, const std::string& name)
{
    const Mesh mesh = with_normals(source);
    const WeldedMesh welded(mesh);
    Displaced result;
    std::vector<std::uint8_t> exponents = find_exponents(mesh, welded, by, result.wanted_triangles);
    check_size(mesh, Subdivision::size(mesh, welded, exponents), file, name);
    const Subdivision cut(mesh, welded, std::move(exponents));
    result.mesh = Displacer(mesh, welded, cut).run(by);
    return result;
}

}  // namespace fathom
