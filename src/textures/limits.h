// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/node.h"

namespace fathom {
inline namespace FATHOM_LANES {

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

}  // namespace FATHOM_LANES
}  // namespace fathom
