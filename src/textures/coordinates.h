// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/mapping.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Texture coordinates as a color: u is red, v is green. It serves as input of gradients.
struct CoordinatesTexture {
    static constexpr TextureKind kind = TextureKind::coordinates;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask)
    {
        const TextureUv uv(graph.tables, t, at);
        return {{uv.u, uv.v, Float(0), Float(1)}};
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
