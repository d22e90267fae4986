// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/surface_of_revolution.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fathom {

Mesh turned(const std::vector<ProfilePoint>& profile, double phi_max, int sides)
{
    Mesh mesh;
    const auto rows = std::uint32_t(profile.size());
    double radius = 0;
    for (const ProfilePoint& p : profile) radius = std::max(radius, std::abs(p.radius));
    // The tolerance covers sin(pi), which is not exactly 0 in floating point.
    const auto is_pole = [&](const ProfilePoint& p) { return std::abs(p.radius) < 1e-12 * radius; };
    for (int i = 0; i <= sides; ++i) {
        const double phi = phi_max * i / sides, c = std::cos(phi), s = std::sin(phi);
        for (const ProfilePoint& p : profile) {
            mesh.positions.push_back({float(p.radius * c), float(p.radius * s), float(p.z)});
            mesh.normals.push_back({float(p.normal_radius * c), float(p.normal_radius * s), float(p.normal_z)});
            mesh.uvs[0].push_back({float(i) / float(sides), float(p.v)});
        }
    }
    for (std::uint32_t i = 0; i < std::uint32_t(sides); ++i)
        for (std::uint32_t j = 0; j + 1 < rows; ++j) {
            const std::uint32_t a = i * rows + j, b = a + rows;
            // At a pole one of the two triangles is degenerate.
            if (!is_pole(profile[j])) mesh.indices.insert(mesh.indices.end(), {a, b, b + 1});
            if (!is_pole(profile[j + 1])) mesh.indices.insert(mesh.indices.end(), {a, b + 1, a + 1});
        }
    return mesh;
}

}  // namespace fathom
