// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/mesh_cleanup.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>

namespace fathom {

namespace {

/// Twice the area times the unit normal. In double, differences of floats are exact enough that degenerate triangles
/// give exactly 0.
Vec3d area_vector(const Mesh& mesh, std::size_t i)
{
    const Vec3d a = to_double(mesh.positions[mesh.indices[i]]);
    const Vec3d b = to_double(mesh.positions[mesh.indices[i + 1]]);
    const Vec3d c = to_double(mesh.positions[mesh.indices[i + 2]]);
    return cross(b - a, c - a);
}

/// Whether area_vector is not 0. NaN counts as area: positions that are not finite are reported later as an error.
/// Usually the first component decides.
bool has_area(const Mesh& mesh, std::size_t i)
{
    const Vec3d a = to_double(mesh.positions[mesh.indices[i]]);
    const Vec3d b = to_double(mesh.positions[mesh.indices[i + 1]]) - a;
    const Vec3d c = to_double(mesh.positions[mesh.indices[i + 2]]) - a;
    return b.x * c.y - b.y * c.x != 0 || b.y * c.z - b.z * c.y != 0 || b.z * c.x - b.x * c.z != 0;
}

/// Indices of degenerate triangles, ascending.
std::vector<std::size_t> without_area(const Mesh& mesh)
{
    using Found = std::vector<std::size_t>;
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, mesh.indices.size() / 3, 1 << 14), Found(),
        [&](const tbb::blocked_range<std::size_t>& range, Found found) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                if (!has_area(mesh, 3 * i)) found.push_back(i);
            return found;
        },
        // Ranges are joined in order.
        [](Found a, const Found& b) {
            a.insert(a.end(), b.begin(), b.end());
            return a;
        });
}

std::size_t remove_degenerate(Mesh& mesh)
{
    const std::vector<std::size_t> removed = without_area(mesh);
    if (removed.empty()) return 0;
    const auto triangle = [&](std::size_t i) { return mesh.indices.begin() + std::ptrdiff_t(3 * i); };
    auto kept = triangle(removed[0]);
    for (std::size_t k = 0; k < removed.size(); ++k) {
        const auto end = k + 1 < removed.size() ? triangle(removed[k + 1]) : mesh.indices.end();
        kept = std::copy(triangle(removed[k] + 1), end, kept);
    }
    mesh.indices.erase(kept, mesh.indices.end());
    return removed.size();
}

bool is_good(Vec3f n)
{
    const float l2 = n.x * n.x + n.y * n.y + n.z * n.z;
    return std::isfinite(l2) && l2 > 0;
}

std::size_t replace_normals(Mesh& mesh)
{
    std::size_t bad = 0;
    for (Vec3f n : mesh.normals) bad += !is_good(n);
    if (bad == 0) return 0;
    std::vector<Vec3d> sums(mesh.positions.size());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const Vec3d area = area_vector(mesh, i);
        for (std::size_t k = 0; k < 3; ++k) sums[mesh.indices[i + k]] = sums[mesh.indices[i + k]] + area;
    }
    std::size_t replaced = 0;
    std::vector<char> used(mesh.positions.size(), 0);
    for (std::uint32_t index : mesh.indices) used[index] = 1;
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        if (is_good(mesh.normals[i])) continue;
        const Vec3d n = normalize(sums[i]);
        mesh.normals[i] = length(n) > 0.5 ? Vec3f{float(n.x), float(n.y), float(n.z)} : Vec3f{0, 0, 1};
        // Normals of unused vertices are not counted.
        replaced += std::size_t(used[i]);
    }
    return replaced;
}

template <class T>
std::size_t zero_unless_finite(std::vector<T>& values)
{
    std::size_t bad = 0;
    for (T& value : values) {
        float* p = &value.x;
        for (std::size_t k = 0; k < sizeof(T) / sizeof(float); ++k)
            if (!std::isfinite(p[k])) p[k] = 0, ++bad;
    }
    return bad;
}

}  // namespace

void clean_mesh(Mesh& mesh, const std::string& file, MeshFaults& faults)
{
    faults.add(MeshFaults::degenerate_triangles, file, remove_degenerate(mesh));
    faults.add(MeshFaults::normals_without_direction, file, replace_normals(mesh));
    std::size_t bad =
        zero_unless_finite(mesh.uvs[0]) + zero_unless_finite(mesh.uvs[1]) + zero_unless_finite(mesh.colors);
    bad += zero_unless_finite(mesh.tangents);
    faults.add(MeshFaults::values_not_finite, file, bad);
}

}  // namespace fathom
