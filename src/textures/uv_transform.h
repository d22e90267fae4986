// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/mapping.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Evaluates another texture with both uv sets replaced by transformed coordinates.
struct UvTransformTexture {
    static constexpr TextureKind kind = TextureKind::uv_transform;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const TextureUv uv(graph.tables, t, at);
        TexturePoint there = at;
        for (int set = 0; set < 2; ++set) there.u[set] = uv.u, there.v[set] = uv.v;
        return graph.color_a(t, there, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
