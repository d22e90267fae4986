// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/vertex_normals.h"

#include <algorithm>
#include <cmath>

namespace fathom {

void set_vertex_normals(Mesh& mesh, NormalWeight weight)
{
    std::vector<Vec3d> sums(mesh.positions.size());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        Vec3d p[3];
        for (std::size_t k = 0; k < 3; ++k) p[k] = to_double(mesh.positions[mesh.indices[i + k]]);
        const Vec3d area = cross(p[1] - p[0], p[2] - p[0]), normal = normalize(area);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d a = normalize(p[(k + 1) % 3] - p[k]), b = normalize(p[(k + 2) % 3] - p[k]);
            Vec3d& sum = sums[mesh.indices[i + k]];
            sum = sum + (weight == NormalWeight::area ? area : normal * std::acos(std::clamp(dot(a, b), -1.0, 1.0)));
        }
    }
    mesh.normals.resize(mesh.positions.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const Vec3d n = normalize(sums[i]);
        mesh.normals[i] = length(n) > 0.5 ? to_float(n) : Vec3f{0, 0, 1};
    }
}

}  // namespace fathom
