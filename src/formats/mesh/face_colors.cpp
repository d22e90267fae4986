// SPDX-License-Identifier: Apache-2.0
#include "formats/mesh/face_colors.h"

#include <bit>

#include "formats/mesh/vertex_index.h"

namespace fathom {

namespace {

template <class T>
void reindex(std::vector<T>& values, const std::vector<std::uint32_t>& from)
{
    if (values.empty()) return;
    std::vector<T> taken;
    taken.reserve(from.size());
    for (const std::uint32_t i : from) taken.push_back(values[i]);
    values = std::move(taken);
}

}  // namespace

void set_face_colors(Mesh& mesh, const std::vector<Vec4f>& colors)
{
    VertexIndex tints, colors_of_tints, vertices;
    std::vector<std::uint32_t> from;  // for each new vertex, the vertex that it duplicates
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
    reindex(mesh.positions, from);
    reindex(mesh.normals, from);
    reindex(mesh.tangents, from);
    for (std::vector<Vec2f>& uvs : mesh.uvs) reindex(uvs, from);
}

}  // namespace fathom
