// SPDX-License-Identifier: Apache-2.0
/// This file is compiled for one lane (FATHOM_ONE_LANE). Scene compilation evaluates textures by the code that shading
/// uses, and gets bitwise equal results from each kernel.
#include "kernel/kernel.h"
#include "textures/textures.h"

namespace fathom {

void look_up_texture(const ShadingTables& tables, std::uint32_t texture, std::uint32_t channel,
                     const KernelTexturePoint* points, std::size_t count, float* values)
{
    static_assert(lanes == 1);
    const TextureGraph graph(tables);
    for (std::size_t i = 0; i < count; ++i) {
        const KernelTexturePoint& point = points[i];
        TexturePoint at;
        for (int set = 0; set < 2; ++set) at.u[set] = point.uv[set].x, at.v[set] = point.uv[set].y;
        at.p_world = Vec3(point.position.x, point.position.y, point.position.z);
        at.n_world = Vec3(0, 0, 0);
        const Vec4f& color = point.vertex_color;
        at.vertex_color[0] = color.x, at.vertex_color[1] = color.y;
        at.vertex_color[2] = color.z, at.vertex_color[3] = color.w;
        values[i] = graph.evaluate(tables.textures[texture], at, true).common_channel(channel);
    }
}

}  // namespace fathom
