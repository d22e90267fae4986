// SPDX-License-Identifier: Apache-2.0
#include "geometry/compile/parallelograms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "compile/render_space.h"

namespace fathom {

namespace {

using Triangle = std::array<Vec3d, 3>;

/// The parallelogram of two triangles that share an edge, with the opposite vertex of the first as its corner; nothing
/// if they do not form one.
std::optional<Rectangle> join(const Triangle& a, const Triangle& b)
{
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const Vec3d r = a[i], p = a[(i + 1) % 3], q = a[(i + 2) % 3];
            // The other triangle traverses the common edge in the opposite direction.
            if (!(b[(j + 1) % 3] == q) || !(b[(j + 2) % 3] == p)) continue;
            const Vec3d gap = p + q - r - b[j];
            if (length(gap) <= 1e-6 * std::max(length(p - r), length(q - r))) return Rectangle{r, p - r, q - r};
        }
    return {};
}

}  // namespace

bool has_flat_normals(const Mesh& mesh)
{
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) { return to_double(mesh.positions[mesh.indices[i + k]]); };
        const Vec3d n = cross(corner(1) - corner(0), corner(2) - corner(0));
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d shading = to_double(mesh.normals[mesh.indices[i + k]]);
            // The tangent of the angle between both normals must be small; normals from files are rounded.
            if (!(length(cross(n, shading)) <= 1e-4 * dot(n, shading))) return false;
        }
    }
    return true;
}

Parallelograms pair_triangles(const Mesh& mesh)
{
    const std::size_t count = mesh.indices.size() / 3;
    const auto triangle = [&](std::size_t k) {
        const auto at = [&](std::size_t c) { return to_double(mesh.positions[mesh.indices[3 * k + c]]); };
        return Triangle{at(0), at(1), at(2)};
    };
    Parallelograms result;
    std::vector<bool> used(count);
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = i + 1; j < count && !used[i]; ++j) {
            if (used[j]) continue;
            if (const std::optional<Rectangle> joined = join(triangle(i), triangle(j))) {
                result.found.push_back(*joined);
                used[i] = used[j] = true;
            }
        }
        if (!used[i]) result.triangles.insert(result.triangles.end(), &mesh.indices[3 * i], &mesh.indices[3 * i] + 3);
    }
    return result;
}

}  // namespace fathom
