// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Nodes that compute a color from the colors of other nodes.
#include "textures/mapping.h"

namespace fathom {
inline namespace FATHOM_LANES {

/// Linear interpolation between two colors by a factor.
struct MixTexture {
    static constexpr TextureKind kind = TextureKind::mix;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        return graph.mix(t, graph.factor(t, at, m), at, m);
    }
};

/// Product of two colors.
struct ScaleTexture {
    static constexpr TextureKind kind = TextureKind::scale;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        Texel a = graph.color_a(t, at, m);
        const Texel b = graph.color_b(t, at, m);
        for (int c = 0; c < 4; ++c) a.c[c] = a.c[c] * b.c[c];
        return a;
    }
};

/// 1 minus a color, at least 0 per channel.
struct InvertTexture {
    static constexpr TextureKind kind = TextureKind::invert;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        Texel r = graph.color_a(t, at, m);
        for (int c = 0; c < 3; ++c) r.c[c] = max(Float(1) - r.c[c], Float(0));
        return r;
    }
};

/// A color clamped to [0, 1] per channel.
struct ClampTexture {
    static constexpr TextureKind kind = TextureKind::clamp;

    static Texel evaluate(const TextureGraph& graph, const TextureRecord& t, const TexturePoint& at, Mask m)
    {
        Texel r = graph.color_a(t, at, m);
        for (int c = 0; c < 3; ++c) r.c[c] = clamp(r.c[c], Float(0), Float(1));
        return r;
    }
};

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
