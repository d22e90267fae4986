// SPDX-License-Identifier: Apache-2.0
#include "formats/pbrt/default_uvs.h"

#include "formats/mesh/gather.h"

namespace fathom::pbrt {

namespace {

// Fathom's v grows downward.
constexpr Vec2f square[] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};

/// Whether two triangles form a fan about their first corner, as convex quadrilaterals are triangulated.
bool is_fan(const std::uint32_t* corners)
{
    return corners[0] == corners[3] && corners[2] == corners[4];
}

}  // namespace

void add_default_uvs(Mesh& mesh, const std::vector<std::uint32_t>& quads)
{
    const std::size_t count = mesh.indices.size();
    std::vector<Vec2f> uvs;
    uvs.reserve(count);
    for (std::size_t i = 0; i < count; ++i) uvs.push_back(square[i % 3]);
    for (const std::uint32_t first : quads) {
        const std::size_t second = 3 * (std::size_t(first) + 1);
        if (second + 2 >= count || !is_fan(&mesh.indices[second - 3])) continue;
        uvs[second + 1] = square[2], uvs[second + 2] = square[3];
    }
    gather(mesh.positions, mesh.indices);
    gather(mesh.normals, mesh.indices);
    gather(mesh.colors, mesh.indices);
    mesh.uvs[0] = std::move(uvs);
    for (std::size_t i = 0; i < count; ++i) mesh.indices[i] = std::uint32_t(i);
}

}  // namespace fathom::pbrt
