// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/node.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Interpolated vertex color of the mesh.
struct VertexColorTexture {
    static constexpr TextureKind kind = TextureKind::vertex_color;

    static Texel evaluate(const TextureGraph&, const TextureRecord&, const TexturePoint& at, Mask)
    {
        Texel r;
        for (int c = 0; c < 4; ++c) r.c[c] = at.vertex_color[c];
        return r;
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
