// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Patterns that alternate between two colors.
#include "textures/improved_noise.h"
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

/// Polka dots in texture coordinates: noise chooses which cells have a dot, and its position in the cell, as in pbrt's
/// dots texture.
struct DotsTexture {
    static constexpr TextureKind kind = TextureKind::dots;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        constexpr float radius = 0.35f, farthest = 0.5f - radius;
        const TextureUv uv(graph.tables, t, at);
        const Float u = uv.u * Float(t.scale), v = uv.v * Float(t.scale);
        // Cells are centered at integer coordinates.
        const Float column = floor(u + Float(0.5f)), row = floor(v + Float(0.5f));
        const auto noise = [&](float du, float dv) {
            return improved_noise({column + Float(du), row + Float(dv), Float(0.5f)});
        };
        const Float x = u - fma(noise(1.5f, 2.8f), Float(farthest), column),
                    y = v - fma(noise(4.5f, 9.8f), Float(farthest), row);
        const Mask inside = (noise(0.5f, 0.5f) > Float(0)) & (fma(x, x, y * y) < Float(radius * radius));
        return graph.mix(t, select(inside, Float(1), Float(0)), at, m);
    }
};

}  // namespace FATHOM_LANES
}  // namespace fathom
