// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/face_colors.h"

#include <bit>

#include "formats/mesh/gather.h"
#include "formats/mesh/vertex_index.h"

namespace fathom {

void set_face_colors(Mesh& mesh, const std::vector<Vec4f>& colors)
{
    VertexIndex tints, colors_of_tints, vertices;
    std::vector<std::uint32_t> from;  // for each new vertex, the index of the vertex that it duplicates
    mesh.colors.clear();
    const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const Vec4f& c = colors[i / 3];
        const std::uint32_t color = colors_of_tints({tints({bits(c.x), bits(c.y), bits(c.z)}), bits(c.w), 0});
        const std::uint32_t vertex = vertices({mesh.indices[i], color, 0});
        if (vertex == from.size()) {
            from.push_back(mesh.indices[i]);
            mesh.colors.push_back(c);
        }
        mesh.indices[i] = vertex;
    }
    gather(mesh.positions, from);
    gather(mesh.normals, from);
    gather(mesh.tangents, from);
    for (std::vector<Vec2f>& uvs : mesh.uvs) gather(uvs, from);
}

}  // namespace fathom
