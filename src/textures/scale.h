// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "textures/node.h"

namespace fathom {
inline namespace FATHOM_LANES {

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

}  // namespace FATHOM_LANES
}  // namespace fathom
