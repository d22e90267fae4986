// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/mesh_sides.h"

#include <utility>

namespace fathom {

void orient_to_normals(Mesh& mesh)
{
    if (mesh.normals.size() != mesh.positions.size()) return;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const std::uint32_t* const t = &mesh.indices[i];
        const Vec3d p[3] = {to_double(mesh.positions[t[0]]), to_double(mesh.positions[t[1]]),
                            to_double(mesh.positions[t[2]])};
        const Vec3d sum = to_double(mesh.normals[t[0]]) + to_double(mesh.normals[t[1]]) + to_double(mesh.normals[t[2]]);
        if (dot(cross(p[1] - p[0], p[2] - p[0]), sum) < 0) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    }
}

void flip(Mesh& mesh)
{
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    for (Vec3f& n : mesh.normals) n = {-n.x, -n.y, -n.z};
}

}  // namespace fathom
