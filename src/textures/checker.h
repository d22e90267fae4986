// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/mapping.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Checkerboard in texture coordinates.
struct CheckerUvTexture {
    static constexpr TextureKind kind = TextureKind::checker_uv;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const TextureUv uv(graph.tables, t, at);
        const Float cell = floor(uv.u * Float(t.scale)) + floor(uv.v * Float(t.scale));
        return graph.mix(t, cell - floor(cell * Float(0.5f)) * Float(2), at, m);
    }
};

/// Checkerboard of cubes in space, as in "Ray Tracing: The Next Week": by the sign of a product of sines.
struct CheckerSpaceTexture {
    static constexpr TextureKind kind = TextureKind::checker_space;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        const Vec3 p = texture_space_point(graph.tables, t, at) * Float(t.scale);
        const auto sine = [](Float x) { return sincos_2pi(x * Float(0.5f * inv_pi)).sin; };
        const Float odd = select(sine(p.x) * sine(p.y) * sine(p.z) < Float(0), Float(1), Float(0));
        return graph.mix(t, odd, at, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
