// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Nodes that read properties of the surface.
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

/// Mixes two colors by the abs cosine between the geometric normal and a direction, such as for snow on horizontal
/// surfaces.
struct FacingTexture {
    static constexpr TextureKind kind = TextureKind::facing;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const Vec3 direction(Float(t.direction[0]), Float(t.direction[1]), Float(t.direction[2]));
        return graph.mix(t, abs(dot(at.n_world, direction)), at, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
